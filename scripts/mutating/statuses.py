"""What became of a mutant."""

KILLED = "killed"
SURVIVED = "survived"
TIMEOUT = "timeout"
INVALID = "does not compile"
UNTESTED = "no test"
EQUIVALENT = "equivalent"
#: Until the tests of other folders have judged it.
WAITING = "waiting"
