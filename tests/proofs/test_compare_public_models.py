"""`compare` on three public models of this arm: what is wrong with them, by name.

Each diagnosis was found by hand from the files. Without the files, it is skipped.
"""

from __future__ import annotations

import pytest
import shared_recordings as recordings
from alpha5_model.proofs.comparison.chains import find_chains
from alpha5_model.proofs.comparison.measure import compare

import alpha5_model as a5
from alpha5_model.description.reading import read_urdf
from alpha5_model.numbers.parameters import parameters

MODELS = recordings.RECORDINGS / "models"
HKOLANO = {
    f"axis_{axis}": f"r5m_joint{n}"
    for axis, n in zip("edcb", (5, 4, 3, 2), strict=True)
}
I_LINK = (
    "an earlier revision's numbers, I_Link used as I_COM "
    "(about the link frame, not the COM: the parallel-axis term twice), "
    "products of inertia have the SolidWorks sign, that of the document, "
    "with the added inertia of a cylinder of water of radius 20 mm and length "
)
CYLINDER = "a guess without products of inertia: a solid cylinder of radius 20.0 mm"

MASS_2 = a5.parameters().links[2].mass
#: link -> texts, one of which each finding of that link must have, in any order
TRUTH = {
    "evan_palmer_alpha": {
        "link_0": (
            "dummy link base_link has 0.1 g and 0.0001 kg m^2",
            "kg: an earlier revision's mass",
            "COM 7.6 mm off",
            f"{CYLINDER} and length 149.9 mm",
        ),
        "link_1": (
            "kg: an earlier revision's mass",
            f"{CYLINDER} and length 33.0 mm",
        ),
        "link_2": (
            f"mass 0.429 kg in place of {MASS_2:.4g} kg: an earlier revision's mass",
            "COM 1.8 mm off",
            f"{CYLINDER} and length 154.0 mm",
        ),
        "link_3": (
            "mass 0.115 kg in place of 0.142 kg: an earlier revision's mass",
            "COM 8.8 mm off",
            f"{CYLINDER} and length 32.9 mm",
        ),
        "link_4": (
            "dummy links ee_base_link, push_rod, standard_jaws_tool "
            "have 0.1 g and 0.0001 kg m^2",
            "mass 0.3333 kg in place of 0.355 kg: an earlier revision's mass",
            "5.76 times about x, y, z (z is the wrist's roll)",
            "m1_link a solid cylinder of radius 20.0 mm and length 100.0 mm",
            "standard_jaws_rs1_130_link a solid box of 12 x 30 x 90 mm",
        ),
    },
    "hkolano_blue_rov": {
        "link_0": (
            "mass 0.53 kg in place of 0.234 kg: "
            "an earlier revision's mass and the water's added mass",
            "an earlier revision's numbers",
            f"{I_LINK}150 mm (strip theory)",
        ),
        "link_1": (
            "kg: an earlier revision's mass and the water's added mass, 32 g",
            "mm off: an earlier revision's numbers",
            f"{I_LINK}26 mm (strip theory)",
        ),
        "link_2": (
            f"mass 0.63 kg in place of {MASS_2:.4g} kg: "
            "an earlier revision's mass and the water's added mass, 201 g",
            "mm off: an earlier revision's numbers",
            f"{I_LINK}160 mm (strip theory)",
        ),
        "link_3": (
            "kg: an earlier revision's mass and the water's added mass, 32 g",
            "mm off: an earlier revision's numbers, the sign of z is wrong (mirrored)",
            f"{I_LINK}26 mm (strip theory)",
        ),
        "link_4": (
            "r5m_wrist_link has "
            "an earlier revision's mass and the water's added mass, 226 g",
            "r5m_jaw, r5m_jaw1, r5m_jaw2 with 110 g: the jaws are counted twice",
            "r5m_wrist_link has "
            "an earlier revision's numbers, the sign of y is wrong (mirrored)",
            f"{I_LINK}180 mm (strip theory)",
        ),
    },
    "diff_uvms": {
        "link_0": (
            "kg: an earlier revision's mass",
            "mm off: an earlier revision's numbers",
        ),
        "link_1": (
            "kg: an earlier revision's mass",
            "an earlier revision's numbers, in a frame that is not inertial frame {1}",
            "an earlier revision's numbers, turned by pi about z",
        ),
        "link_2": (
            "kg: an earlier revision's mass",
            "COM 116.5 mm off: "
            "Table 2's numbers, in a frame that is not inertial frame {2}",
            "an earlier revision's numbers, "
            "in axes that are not those of inertial frame {2}",
        ),
        "link_3": (
            "kg: an earlier revision's mass",
            "COM 30.5 mm off: "
            "an earlier revision's numbers, in the wrong axes (x, -z, y)",
            "an earlier revision's numbers, in the wrong axes (x, -z, y)",
        ),
        "link_4": (
            "kg: an earlier revision's mass",
            "COM 165.9 mm off: "
            "the wrist's COM is on the wrong side of the joint (z = +65.0 mm): "
            "an earlier revision's numbers, in a frame that is not inertial frame {4}",
            "an earlier revision's numbers, "
            "in axes that are not those of inertial frame {4}",
        ),
    },
}


@pytest.mark.skipif(not MODELS.is_dir(), reason="no public models beside the checkout")
@pytest.mark.parametrize("name", TRUTH)
def test_what_is_wrong_with_public_models_is_said_by_name(name):
    comparison = compare(
        MODELS / f"{name}.urdf", HKOLANO if name.startswith("hk") else None
    )
    for link, texts in TRUTH[name].items():
        said = [f.text for f in comparison.findings if f.where == link]
        for text in texts:
            assert any(text in one for one in said), (link, text, said)
    costs = [f.cost for f in comparison.findings]
    assert costs == sorted(costs, reverse=True)


@pytest.mark.skipif(not MODELS.is_dir(), reason="no public models beside the checkout")
def test_most_efforts_are_9_newton_metres_but_not_all():
    efforts = {
        path.stem: [
            joint.effort
            for joint in find_chains(read_urdf(path), parameters())[0].joints
        ]
        for path in sorted(MODELS.glob("*.urdf"))
    }
    placeholders = [all(effort == 9.0 for effort in four) for four in efforts.values()]
    assert sum(placeholders) > len(placeholders) / 2
    assert efforts["hkolano_blue_rov"] == [9.0, 9.0, 9.0, 5.0]
