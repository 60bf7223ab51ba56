"""Recorded corrections: every departure from the document's text, by name.

Published numbers are never changed silently. A correction is applied only when its name is in the
``corrections`` that `alpha5_model.parameters` is given; ``corrections=()`` is the text to the
letter.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass

from alpha5_model.checks import named


@dataclass(frozen=True)
class Correction:
    """A departure from the document.

    Attributes:
        name: The name to ask for it by.
        statement: What the document says, and what the correction says.
        evidence: Why.
        effect: What it changes in the model.
    """

    name: str
    statement: str
    evidence: str
    effect: str


#: Every correction by its name.
CORRECTIONS: dict[str, Correction] = {
    correction.name: correction
    for correction in (
        Correction(
            name="base_frame",
            statement="Section 2 puts inertial frame {0} at DH frame {0} after the rotation pi; "
            "the correction takes DH frame {0} itself.",
            evidence="Figures 1 and 7 draw the base body on the -x side of DH frame {0}; Table 2's COM "
            "(-52.425 mm) and Table 3's COB (-53 mm) lie on that side only without the rotation.",
            effect="Turns link_0 by pi about z. The torques of a fixed-base arm stay the same; the load "
            "on the mount and every floating-base result change.",
        ),
        Correction(
            name="link3_cob",
            statement="Table 3 prints link 3's centre of buoyancy as (2, -4, 29) mm; the correction reads "
            "it in the convention of link 1's frame and expresses it in inertial frame {3}.",
            evidence="z = 29 mm is outside the body (|z| <= 20 mm), which a centroid cannot be. Links 1 and 3 "
            "are the same kind of part, and the point expressed in {3} lands within 2 mm of the "
            "centroid of the manufacturer's public CAD.",
            effect="Moves the buoyancy of link 3, 0.032 L, by about 39 mm.",
        ),
    )
}
#: Applied where nothing else is asked for.
DEFAULT_CORRECTIONS: tuple[str, ...] = ("base_frame",)


def check_corrections(corrections: Iterable[str]) -> tuple[str, ...]:
    """The corrections asked for, in the order in which they are recorded, without repetition.

    Raises:
        InputError: Not a collection of names.
        UnknownNameError: A name that is not recorded.
    """
    return named("correction", corrections, tuple(CORRECTIONS))
