"""`compare` on three public models of this arm: what is wrong with them, by name.

Each fault was found by hand from the files, see the README beside them. Without the
files, it is skipped.
"""

from __future__ import annotations

import pytest
import shared_recordings as recordings

import alpha5_model as a5

MODELS = recordings.RECORDINGS / "models"
REVISION = "earlier_revision"
#: Id of a finding, where, and the mistake that is named; None if any may be.
Fault = tuple[str, str, str | None]


def numbers(link: str, *mistakes: str | None) -> list[Fault]:
    """Wrong mass, COM and tensor of a link, with the mistake of each."""
    ids = ("body.mass", "body.com", "body.inertia")
    return [(key, link, m) for key, m in zip(ids, mistakes, strict=True)]


FAULTS: dict[str, list[Fault]] = {
    # Guessed solid cylinders, dummies of 0.1 g with 1e-4 kg m^2, a slow wrist roll.
    "evan_palmer_alpha": [
        ("height", "axis_d", ""),
        ("dummy", "link_0", ""),
        *numbers("link_0", REVISION, None, None),
        *numbers("link_1", REVISION, None, None),
        *numbers("link_2", REVISION, None, None),
        *numbers("link_3", REVISION, None, None),
        ("dummy", "link_4", ""),
        *numbers("link_4", None, None, None),
        ("mimic", "standard_jaws_rs1_130_joint", ""),
        ("lint.doubled", "standard_jaws_base_joint", ""),
    ],
    # Masses with added water in them, an earlier revision's I_Link used as I_COM, and a
    # vehicle of 25 kg on link_0.
    "hkolano_blue_rov": [
        ("carried", "base", ""),
        ("zero", "axis_e", ""),
        *numbers("link_0", None, REVISION, None),
        *numbers("link_1", None, REVISION, None),
        *numbers("link_2", None, REVISION, None),
        *numbers("link_3", None, f"{REVISION}.com_sign_z", None),
        *numbers("link_4", None, None, None),
    ],
    # An earlier revision's numbers, in other frames than the document's.
    "diff_uvms": [
        ("height", "axis_d", ""),
        ("mimic", "alpha_standard_jaws_rs1_130_joint", ""),
        *numbers("link_0", REVISION, REVISION, REVISION),
        *numbers("link_1", REVISION, f"{REVISION}.other_frame", None),
        *numbers("link_2", REVISION, "other_frame", None),
        *numbers("link_3", REVISION, None, None),
        *numbers("link_4", REVISION, f"{REVISION}.other_frame", None),
        ("lint.no_inertia", "alpha_push_rod", ""),
    ],
}


@pytest.mark.skipif(not MODELS.is_dir(), reason="no public models beside the checkout")
@pytest.mark.parametrize("name", FAULTS)
def test_what_is_wrong_with_public_models_is_found_and_named(name: str) -> None:
    comparison = a5.compare(MODELS / f"{name}.urdf")
    found = [(f.id, f.where, f.mistake) for f in comparison.findings]
    for key, where, mistake in FAULTS[name]:
        named = [one[2] for one in found if one[:2] == (key, where)]
        assert named, (key, where)
        assert mistake is None or mistake in named, (key, where, named)
    costs = [f.cost for f in comparison.findings]
    assert costs == sorted(costs, reverse=True)
    # Its meshes are one remark, not one for each.
    assert [f.id for f in comparison.findings].count("file") <= 1
