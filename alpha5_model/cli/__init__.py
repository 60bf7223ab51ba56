"""The ``alpha5`` command: one module per subcommand, no physics in here."""

from alpha5_model.cli.program import COMMANDS, main, run

__all__ = ["COMMANDS", "main", "run"]
