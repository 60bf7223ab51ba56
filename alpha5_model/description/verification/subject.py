"""A URDF file that is checked, and the record of one check of it."""

from __future__ import annotations

import os
from dataclasses import dataclass
from pathlib import Path
from typing import Literal

from alpha5_model.description.reading import read_urdf
from alpha5_model.description.urdf_robot import UrdfJoint, UrdfRobot
from alpha5_model.numbers.parameters import Alpha5Parameters

Verdict = Literal["passed", "failed", "not run"]
JAW_LINKS = ("jaw_rod", "finger_1", "finger_2")


@dataclass(frozen=True)
class FileCheck:
    """One check of one file.

    Attributes:
        file: Name of the file.
        check: What was checked.
        verdict: ``passed``, ``failed`` or ``not run``.
        finding: What was found, in one sentence.
        measured: The largest deviation, in ``unit``; None if nothing is measured.
        bound: The largest deviation that passes.
        unit: Unit of ``measured`` and ``bound``.
    """

    file: str
    check: str
    verdict: Verdict
    finding: str
    measured: float | None = None
    bound: float | None = None
    unit: str = ""


@dataclass(frozen=True, eq=False, kw_only=True)
class Subject(UrdfRobot):
    """A URDF file that is checked.

    Attributes:
        path: The file.
        prefix: Prefix of its names: the text before ``base_link``.
        expected: The arm that it should describe.
    """

    path: Path
    prefix: str
    expected: Alpha5Parameters

    @classmethod
    def read(cls, path: str | os.PathLike[str], expected: Alpha5Parameters) -> Subject:
        """Read a file; see `read_urdf` for what it raises."""
        robot = read_urdf(Path(path))
        base = [name for name in robot.links if name.endswith("base_link")]
        prefix = base.pop().removesuffix("base_link") if len(base) == 1 else ""
        return cls(
            name=robot.name,
            root=robot.root,
            links=robot.links,
            joints=robot.joints,
            path=Path(path),
            prefix=prefix,
            expected=expected,
        )

    def row(
        self,
        check: str,
        verdict: Verdict,
        finding: str,
        measured: float | None = None,
        bound: float | None = None,
        unit: str = "",
    ) -> FileCheck:
        """A row about this file; see `FileCheck`."""
        return FileCheck(
            file=self.path.name,
            check=check,
            verdict=verdict,
            finding=finding,
            measured=measured,
            bound=bound,
            unit=unit,
        )

    @property
    def jaws(self) -> bool:
        """Whether there is a link of moving jaws."""
        return any(self.prefix + name in self.links for name in JAW_LINKS)

    @property
    def carriers(self) -> dict[str, UrdfJoint]:
        """Link -> the joint that carries it."""
        return {joint.child: joint for joint in self.joints.values()}
