"""Known mutants with known outcomes; a run checks them before it draws its sample."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

from mutating.mutants import Mutant
from mutating.statuses import KILLED, SURVIVED


@dataclass(frozen=True)
class Proof:
    """A change of the source, and what the tests of one file must say to it."""

    file: str
    old: str
    new: str
    outcome: str
    test: str

    def mutant(self, text: str) -> Mutant:
        """The mutant of the file's text; its operator is the expected outcome.

        Raises:
            ValueError: If the file no longer contains the part to change.
        """
        start = text.find(self.old)
        if start < 0:
            raise ValueError(f"{self.file} no longer contains {self.old!r}")
        line = text[:start].count("\n") + 1
        changed = text.replace(self.old, self.new, 1)
        return Mutant(Path(self.file), line, self.outcome, changed)


PROOFS = (
    Proof(
        file="proofs/audit/masses.py",
        old="abs(excess.value) * G",
        new="abs(excess.value) / G",
        outcome=KILLED,
        test="proofs/test_audit",
    ),
    Proof(
        file="proofs/audit/masses.py",
        old="norm(si(",
        new="norm(-si(",
        outcome=SURVIVED,
        test="proofs/test_audit",
    ),
    Proof(
        file="codegen/kernels/rows.h",
        old="return good",
        new="return !good",
        outcome=KILLED,
        test="codegen/test_kernels_compiled",
    ),
    Proof(
        file="codegen/kernels/rows.h",
        old="return good",
        new="return +good",
        outcome=SURVIVED,
        test="codegen/test_kernels_compiled",
    ),
)
