"""The lecture's theorem on dexterous workspaces against the exact condition.

References:
    [Lecture7.1] Describing Robot Arms, the theorem on a planar arm whose tip is pinned.
"""

from __future__ import annotations

import itertools

from alpha5_model.consistency.row import AuditRow, judged
from alpha5_model.kinematics.planar import theorem_row

#: Whole link lengths that are tried; sums and halves of them are exact.
LONGEST = 6


def audit() -> list[AuditRow]:
    """Both directions of the theorem, over every set of whole lengths l_1 ... l_4 up to `LONGEST`."""
    lengths = itertools.product(range(1, LONGEST + 1), repeat=4)
    rows = [(values, theorem_row(*map(float, values))) for values in lengths]
    promised = [row for _, row in rows if row.theorem]
    turning = [(values, row) for values, row in rows if row.exact]
    broken = sum(not row.exact for row in promised)
    missed = [values for values, row in turning if not row.theorem]
    example = ", ".join(map(str, missed[-1])) if missed else "none"
    return [
        judged(
            "lecture.sufficient",
            "Lecture 7.1, theorem",
            "if l_i + l_j >= L/2, link 3 turns fully",
            100 * broken / len(promised),
            "=",
            0.0,
            0.0,
            "%",
            f"share of the {len(promised)} sets of whole lengths up to {LONGEST} that the theorem promises "
            "and that do not turn",
        ),
        judged(
            "lecture.necessary",
            "Lecture 7.1, theorem",
            "only if l_i + l_j >= L/2",
            100 * len(missed) / len(turning),
            "=",
            0.0,
            0.0,
            "%",
            f"share of the {len(turning)} sets of whole lengths up to {LONGEST} that turn fully and that the "
            f"theorem rules out, such as l = ({example}): those where l_4 is the shortest",
        ),
    ]
