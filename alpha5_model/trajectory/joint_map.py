"""The arm's joints under other names: ``joint_1`` for ``axis_e``."""

from __future__ import annotations

import re
from collections.abc import Iterable, Mapping, Sequence

import numpy as np

from alpha5_model._support.checks import FloatArray, choice
from alpha5_model.errors import InputError
from alpha5_model.numbers.tables import JOINT_NAMES


class JointMap:
    """What a file calls the joints of the arm.

    Args:
        joints: Joint of the arm -> its name in the file, ``-NAME`` if it turns the
            other way there; None or empty if the file has the arm's names.

    Raises:
        UnknownNameError: Not a joint of the arm.
        InputError: No mapping, an empty name, or one of several joints.
    """

    def __init__(self, joints: Mapping[str, str] | None) -> None:
        if joints is not None and not isinstance(joints, Mapping):
            expected = "a mapping from joints of the arm to names in the file"
            raise InputError("joints", joints, expected)
        self._ours: dict[str, str] = {}
        self._reversed: set[str] = set()
        for joint, name in (joints or {}).items():
            choice("joint", joint, JOINT_NAMES)
            own = name.removeprefix("-") if isinstance(name, str) else ""
            if not own.strip() or own in self._ours:
                expected = "a name of the file for each joint, each name once"
                raise InputError(f"joints[{joint}]", name, expected)
            self._ours[own] = joint
            if own != name:
                self._reversed.add(joint)

        longest_first = sorted(self._ours, key=len, reverse=True)
        either = "|".join(map(re.escape, longest_first))
        # ``joint_1`` stands in ``left_joint_1_pos``, not in ``joint_10`` or
        # ``myjoint_1``.
        self._names = re.compile(rf"(?<![A-Za-z0-9])(?:{either})(?![A-Za-z0-9])")

    def signs(self, joints: Sequence[str]) -> FloatArray:
        """-1 for each joint that turns the other way in the file, else 1, (n,)."""
        return np.array([-1.0 if joint in self._reversed else 1.0 for joint in joints])

    def renamed(self, names: Iterable[str]) -> list[str]:
        """Names with the arm's joints for those of the file.

        Raises:
            InputError: A name that the file does not have.
        """
        given = [*names]
        if not self._ours:
            return given
        seen: set[str] = set()

        def ours(match: re.Match[str]) -> str:
            seen.add(match[0])
            return self._ours[match[0]]

        renamed = [self._names.sub(ours, name) for name in given]
        missing = [name for name in self._ours if name not in seen]
        if missing:
            joint = self._ours[missing[0]]
            got = ", ".join(dict.fromkeys(given))[:200]
            raise InputError(f"joints[{joint}]", missing[0], f"a name in {got}")
        return renamed
