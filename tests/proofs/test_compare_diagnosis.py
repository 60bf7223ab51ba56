"""`compare` names each known mistake, and nothing for any other number.

The mistakes are made by hand from the typed tables.
"""

from __future__ import annotations

import itertools
import math

import numpy as np
import pytest
import reference

from alpha5_model.numbers.parameters import parameters
from alpha5_model.proofs.comparison.diagnosis import (
    explain_com,
    explain_inertia,
    explain_mass,
)
from alpha5_model.proofs.comparison.document_revisions import revisions
from alpha5_model.proofs.comparison.guesses import explain_guess, solid_of_size
from alpha5_model.proofs.comparison.hypotheses import hypotheses_of
from alpha5_model.proofs.comparison.inertials import Inertial
from alpha5_model.proofs.comparison.own_arm import own_arm_of

LINKS = parameters().links
KNOWN = [hypotheses_of(own_arm_of(parameters()), body) for body in range(5)]
HERE = np.eye(4)

#: The earlier revision, typed again: kg, mm, kg mm^2.
#: Tensors are (xx, yy, zz, xy, xz, yz) in the document's sign.
OLD_MASS = [0.341, 0.194, 0.429, 0.115, 0.333]
OLD_COM = [(-75, -6, -3), (5, -1, 16), (73, 0, 0), (17, -26, 2), (0, -3, -98)]
OLD_INERTIA = [
    (83.66, 998.81, 1003.60, -14.45, 38.27, -3.14),
    (139.10, 158.49, 61.96, 5.97, 38.48, 6.10),
    (86.77, 868.23, 891.46, -73.13, 13.16, -0.03),
    (41.80, 28.30, 45.02, -10.17, -4.91, 5.98),
    (507.87, 535.87, 76.00, 1.97, -4.98, -97.90),
]
OLD_INERTIA_LINK = [
    (99, 2920, 2934, 139, 115, 3),
    (189, 213, 67, 5, 54, 3),
    (87, 3190, 3213, -76, -10, 0),
    (120, 62, 156, -61, -1, 0),
    (3709, 3734, 79, -2, -4, 0),
]
OLD_VOLUME = [0.202, 0.018, 0.203, 0.025, 0.155]
OLD_COB = [(0, 0, 0), (-1, -2, 32), (73, 0, -2), (3, -17, 1), (0, 3, -98)]
NEW, OLD = "Table 2's numbers", "an earlier revision's numbers"
#: For COMs and tensors alike: whose numbers, mass, COM [mm], tensor.
SETS = [
    (NEW, reference.MASS, reference.COM, reference.INERTIA),
    (OLD, OLD_MASS, OLD_COM, OLD_INERTIA),
]


def tensor(numbers, sign: float = -1.0) -> np.ndarray:
    """In the URDF's sign, or with +1 as the document prints it, [kg m^2]."""
    xx, yy, zz, xy, xz, yz = (x * 1e-6 for x in numbers)
    xy, xz, yz = sign * xy, sign * xz, sign * yz
    return np.array([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]])


def steiner(mass: float, p) -> np.ndarray:
    p = np.asarray(p)
    return mass * (p @ p * np.eye(3) - np.outer(p, p))


def turned(axis: int, angle: float) -> np.ndarray:
    c, s = math.cos(angle), math.sin(angle)
    i, j = (axis + 1) % 3, (axis + 2) % 3
    out = np.eye(3)
    out[i, i] = out[j, j] = c
    out[j, i], out[i, j] = s, -s
    return out


#: A link frame of no meaning: 20, 30 and 50 mm away and turned about two axes.
ASTRAY = np.eye(4)
ASTRAY[:3, :3] = turned(0, 0.7) @ turned(2, 1.1)
ASTRAY[:3, 3] = (0.02, 0.03, 0.05)


def com_reason(body: int, com, pose=HERE) -> str | None:
    """The reason for a COM (3,) [m] as written in a link at ``pose`` in our frame."""
    return explain_com(
        KNOWN[body], Inertial("limb", 0.2, np.array(com, float), np.eye(3), pose)
    )


def inertia_reason(
    body: int, inertia, pose=HERE, mass: float | None = None
) -> str | None:
    mass = reference.MASS[body] if mass is None else mass
    return explain_inertia(
        KNOWN[body], Inertial("limb", mass, np.zeros(3), np.array(inertia), pose)
    )


def mass_reason(body: int, mass: float, inertia=None) -> str | None:
    inertia = np.eye(3) if inertia is None else inertia
    return explain_mass(KNOWN[body], Inertial("limb", mass, np.zeros(3), inertia, HERE))


# ------------------------------------------------------ the earlier revision's numbers


def test_the_earlier_revision_is_stored_as_typed_here():
    old = revisions()[1]
    np.testing.assert_array_equal(old.mass, OLD_MASS)
    np.testing.assert_allclose(old.com * 1e3, OLD_COM, atol=1e-12)
    np.testing.assert_allclose(old.cob * 1e3, OLD_COB, atol=1e-12)
    np.testing.assert_allclose(old.volume * 1e3, OLD_VOLUME, atol=1e-12)
    for i in range(5):
        np.testing.assert_allclose(old.inertia[i], tensor(OLD_INERTIA[i]), atol=1e-15)
        np.testing.assert_allclose(
            old.inertia_link[i], tensor(OLD_INERTIA_LINK[i]), atol=1e-15
        )


def test_its_two_tensors_agree_to_the_last_digit():
    """I_COM and I_Link come from two public models, and each follows from the other."""
    coms = np.array(OLD_COM, float)
    coms[2], coms[4, 0] = reference.COM[2], reference.COM[4][0]
    for i in range(5):
        moved = tensor(OLD_INERTIA[i], +1) * 1e6 - steiner(OLD_MASS[i], coms[i])
        moved += 2 * np.diag(np.diag(steiner(OLD_MASS[i], coms[i])))
        expected = tensor(OLD_INERTIA_LINK[i], +1) * 1e6
        if i == 4:
            expected[0, 1] = expected[1, 0] = -expected[
                0, 1
            ]  # the one sign the two models differ in
        np.testing.assert_allclose(np.round(moved), expected, atol=1e-9)


# -------------------------------------------------------------------------------- COMs


def exchanges():
    """The 47 ways to exchange and reverse axes: words -> (3, 3)."""
    for order in itertools.permutations("xyz"):
        for signs in itertools.product((1, -1), repeat=3):
            matrix = np.array(
                [
                    [s * (a == b) for b in "xyz"]
                    for a, s in zip(order, signs, strict=False)
                ]
            )
            negative = [a for a, s in zip(order, signs, strict=False) if s < 0]
            positive = [a for a, s in zip(order, signs, strict=False) if s > 0]
            if order != ("x", "y", "z"):
                axes = ", ".join(
                    ("-" if s < 0 else "") + a
                    for a, s in zip(order, signs, strict=False)
                )
                yield f"in the wrong axes ({axes})", matrix
            elif negative:
                yield (
                    {
                        1: f"the sign of {negative[0]} is wrong (mirrored)",
                        2: f"turned by pi about {(positive or 'x')[0]}",
                        3: "mirrored through the origin",
                    }[len(negative)],
                    matrix,
                )


def other_frames(body):
    """transform_body_to_frame at zero, by the reference's own forward kinematics."""
    links, chain = (
        reference.inertial_frames(np.zeros(4)),
        reference.dh_frames(np.zeros(4)),
    )
    for k in range(1, 6):
        yield f"in DH frame {{{k}}}", np.linalg.inv(chain[k]) @ links[body]
    for k in set(range(5)) - {body}:
        yield f"in the frame of link_{k}", np.linalg.inv(links[k]) @ links[body]


def com_mistakes(body):
    """Words -> the COM [mm] that one mistake gives, for both revisions."""
    for whose, _, com, _ in SETS:
        c = np.array(com[body], float)
        yield whose, c
        for words, matrix in exchanges():
            yield f"{whose}, {words}", matrix @ c
        for words, there in other_frames(body):
            yield f"{whose}, {words}", there[:3, :3] @ c + there[:3, 3] * 1e3
        for k in set(range(5)) - {body}:
            yield f"{whose} of link_{k}", np.array(com[k], float)
    yield "the centre of buoyancy of Table 3", np.array(reference.COB[body], float)
    if any(OLD_COB[body]):  # a COM at the origin is rather a missing one
        yield (
            "the centre of buoyancy of an earlier revision",
            np.array(OLD_COB[body], float),
        )


@pytest.mark.parametrize("body", range(5))
def test_each_wrong_com_is_named(body):
    mistakes = dict(com_mistakes(body))
    assert len(mistakes) == 2 * (1 + 47 + 5 + 4 + 4 + 1) - (body == 0)
    exact = 0
    for words, wrong in mistakes.items():
        found = com_reason(body, wrong / 1e3)
        exact += found == words
        # Two mistakes may give one number to 0.1 mm, such as a mirrored zero.
        assert found in mistakes, words
        assert np.abs(mistakes[found] - wrong).max() < 0.1001, (words, found)
    assert exact >= {0: 80, 1: 120, 2: 80, 3: 120, 4: 70}[body]


@pytest.mark.parametrize("body", range(5))
def test_the_right_com_in_a_wrong_frame_is_named(body):
    for whose, _, com, _ in SETS:
        c = np.array(com[body]) / 1e3
        assert com_reason(body, c, ASTRAY) == (
            f"{whose}, in a frame that is not inertial frame {{{body}}}"
        )
    # and seen from our frame, wherever it is written
    c = np.linalg.inv(ASTRAY) @ [*(np.array(reference.COM[body]) / 1e3), 1]
    assert com_reason(body, c[:3], ASTRAY) == NEW


@pytest.mark.parametrize(
    ("shift", "axis", "angle", "same"),
    [
        (1.99e-3, 0, 0.0, True),
        (2.01e-3, 0, 0.0, False),
        (0.0, 1, 0.0199, True),
        (0.0, 1, -0.0199, True),
        (0.0, 1, 0.0201, False),
        (0.0, 2, math.pi, False),
        (0.0, 0, math.pi - 0.01, False),
    ],
)
def test_a_frame_that_is_ours_but_for_the_geometry_is_no_mistake_of_the_body(
    shift, axis, angle, same
):
    pose = np.eye(4)
    pose[:3, :3] = turned(axis, angle)
    pose[2, 3] = shift
    assert (
        Inertial("limb", 0.1, np.zeros(3), np.eye(3), pose).meant_in_our_frame == same
    )
    if same:
        mirrored = np.array(OLD_COM[3]) / 1e3 * [1, 1, -1]
        assert (
            com_reason(3, mirrored, pose) == f"{OLD}, the sign of z is wrong (mirrored)"
        )
        assert inertia_reason(3, tensor(reference.INERTIA[3]), pose) == NEW


def test_public_coms_of_dh_frames_are_named():
    """VincentTUHH/uvms writes version 7's COMs in the DH frames, to the micrometre."""
    for body, com in {
        1: (-0.012254, -0.021162, -0.000112),
        3: (-0.008812, -0.000148, -0.01666),
        4: (-0.00003, 0.079119, 0.001482),
    }.items():
        assert com_reason(body, com) == f"{NEW}, in DH frame {{{body}}}"


def test_two_mistakes_are_named_and_fewer_if_they_suffice():
    c = np.array(reference.COM[3]) / 1e3
    mirrored = c * [1, -1, 1]
    frame = "in a frame that is not inertial frame {3}"
    assert com_reason(3, mirrored, ASTRAY) == (
        f"{NEW}, the sign of y is wrong (mirrored), {frame}"
    )
    there = dict(other_frames(3))["in DH frame {3}"]
    both = there[:3, :3] @ mirrored + there[:3, 3]
    assert (
        com_reason(3, both)
        == f"{NEW}, the sign of y is wrong (mirrored), in DH frame {{3}}"
    )
    assert com_reason(3, np.array(OLD_COB[3]) / 1e3, ASTRAY) == (
        f"the centre of buoyancy of an earlier revision, {frame}"
    )
    # three mistakes fit nothing
    assert com_reason(3, both, ASTRAY) is None
    assert com_reason(3, both * 1e3) is None


def test_units_and_zeros():
    for factor, words in ((1e3, "millimetres"), (1e-3, "kilometres")):
        c = np.array(reference.COM[2]) / 1e3 * factor
        assert com_reason(2, c) == f"{NEW}, written in {words}"
        assert com_reason(2, c, ASTRAY) == f"{NEW}, written in {words}"
    missing = "missing or zero: at the origin of the other model's link frame"
    assert com_reason(0, (0, 0, 0)) == com_reason(2, (0, 0, 0), ASTRAY) == missing
    # far off, and yet near the zeros of a table once divided by a thousand
    assert com_reason(0, (-0.055, 0, 0)) is None


@pytest.mark.parametrize("body", range(5))
def test_no_diagnosis_for_random_coms(body):
    rng = np.random.default_rng(body)
    low, high = LINKS[body].bounds.T
    for pose in (HERE, ASTRAY):
        assert not any(
            com_reason(body, c, pose) for c in rng.uniform(low, high, (250, 3))
        )


# ----------------------------------------------------------------------------- tensors

I_LINK = (
    "I_Link used as I_COM "
    "(about the link frame, not the COM: the parallel-axis term twice)"
)
SOLIDWORKS = "products of inertia have the SolidWorks sign, that of the document"


def tensor_mistakes(body):
    """Words -> the tensor [kg m^2] that one mistake gives, for both revisions."""
    for whose, mass, com, inertia in SETS:
        right = tensor(inertia[body])
        yield whose, right
        yield f"{whose}, {SOLIDWORKS}", tensor(inertia[body], +1)
        yield f"{whose}, the products of inertia are zeroed", np.diag(np.diag(right))
        for i, j in ((0, 1), (0, 2), (1, 2)):
            flipped = right.copy()
            flipped[i, j] = flipped[j, i] = -right[i, j]
            yield f"{whose}, i{'xyz'[i]}{'xyz'[j]} has the wrong sign", flipped
        for words, matrix in exchanges():
            if np.linalg.det(matrix) > 0:
                yield f"{whose}, {words}", matrix @ right @ matrix.T
        for words, there in other_frames(body):
            yield f"{whose}, {words}", there[:3, :3] @ right @ there[:3, :3].T
        term = steiner(mass[body], np.array(com[body]) / 1e3)
        yield f"{whose}, {I_LINK}", right + term
        yield f"{whose}, the parallel-axis term taken off I_COM", right - term
        for k in set(range(5)) - {body}:
            yield f"{whose} of link_{k}", tensor(inertia[k])


@pytest.mark.parametrize("body", range(5))
def test_each_wrong_tensor_is_named(body):
    mistakes = dict(tensor_mistakes(body))
    exact = 0
    for words, wrong in mistakes.items():
        found = inertia_reason(body, wrong)
        exact += found == words
        assert found in mistakes, words
        assert np.abs(mistakes[found] - wrong).max() <= 2e-3 * np.abs(wrong).max(), (
            words,
            found,
        )
    assert exact >= 50


@pytest.mark.parametrize("body", range(5))
def test_the_printed_i_link_of_either_revision_is_named(body):
    document = [
        (56.495, 1043.265, 1059.604, 91.063, -3.655, 0.059),
        (209.962, 232.445, 53.581, 0.976, 60.874, 1.089),
        (82.905, 2903.184, 2924.317, -77.380, -22.366, 0.342),
        (102.986, 58.418, 132.308, -47.813, -0.566, -0.014),
        (4233.813, 4242.419, 63.355, 0.083, -6.827, 52.693),
    ][body]
    for whose, numbers in ((NEW, document), (OLD, OLD_INERTIA_LINK[body])):
        assert inertia_reason(body, tensor(numbers)) == f"{whose}, {I_LINK}"
        assert (
            inertia_reason(body, tensor(numbers, +1))
            == f"{whose}, {I_LINK}, {SOLIDWORKS}"
        )
        # pasted as it is printed into a frame that is not the document's
        axes = f"in axes that are not those of inertial frame {{{body}}}"
        assert (
            inertia_reason(body, tensor(numbers, +1), ASTRAY)
            == f"{whose}, {I_LINK}, {SOLIDWORKS}, {axes}"
        )


def test_tensors_in_other_axes_of_other_masses_and_units():
    right = tensor(reference.INERTIA[3])
    axes = "in axes that are not those of inertial frame {3}"
    assert inertia_reason(3, right, ASTRAY) == f"{NEW}, {axes}"
    assert inertia_reason(3, tensor(reference.INERTIA[3], +1), ASTRAY) == (
        f"{NEW}, {SOLIDWORKS}, {axes}"
    )
    assert (
        inertia_reason(3, right * 1.5, mass=0.142 * 1.5)
        == f"{NEW}, scaled with the wrong mass"
    )
    flipped = tensor(reference.INERTIA[3], +1) * 1.5
    assert inertia_reason(3, flipped, mass=0.142 * 1.5) == (
        f"{NEW}, {SOLIDWORKS}, scaled with the wrong mass"
    )
    for power in (9, 6, 3, -3, -6, -9):
        expected = f"{NEW}, wrong unit, a factor of 1e{power}"
        assert inertia_reason(3, right * 10.0**power) == expected
    assert inertia_reason(3, np.zeros((3, 3))) == "missing or zero"
    assert inertia_reason(3, right * 1.5) is None


@pytest.mark.parametrize("body", range(5))
def test_a_tensor_about_another_point_is_named(body):
    for whose, _, _, inertia in SETS:
        right = tensor(inertia[body])
        for point in ((0.04, -0.02, 0.01), (0.0, 0.0, -0.09)):
            wrong = right + steiner(reference.MASS[body], point)
            away = math.hypot(*point) * 1e3
            expected = f"{whose}, about the wrong point, {away:.1f} mm from the COM"
            assert inertia_reason(body, wrong) == expected
    assert (
        inertia_reason(body, tensor(reference.INERTIA[body]) - steiner(0.01, point))
        is None
    )
    wrong = tensor(reference.INERTIA[body], +1) + steiner(
        reference.MASS[body], (0.04, -0.02, 0.01)
    )
    assert inertia_reason(body, wrong) == (
        f"{NEW}, about the wrong point, 45.8 mm from the COM, {SOLIDWORKS}"
    )


@pytest.mark.slow
@pytest.mark.parametrize("body", range(5))
def test_no_diagnosis_for_random_tensors(body):
    rng = np.random.default_rng(body)
    for full in (True, False):
        for _ in range(100):
            spread = np.diag(rng.uniform(5e-3, 60e-3, 3)) @ (
                np.linalg.qr(rng.normal(size=(3, 3)))[0] if full else np.eye(3)
            )
            second = 0.2 * spread.T @ spread
            wrong = np.trace(second) * np.eye(3) - second
            assert inertia_reason(body, wrong) is None


# -------------------------------------------------------------------- water and masses


def water_on(
    base: np.ndarray, axis: int, length: float, end: bool
) -> tuple[float, np.ndarray]:
    """Added mass, and the tensor with the added inertia of a cylinder of 40 mm.

    Both are by strip theory.
    """
    line = 1000 * math.pi * 0.02**2
    across = np.ones(3)
    across[axis] = 0
    return line * length, base + line * length**3 / (3 if end else 12) * np.diag(across)


@pytest.mark.parametrize(
    ("body", "axis", "length"), [(0, 0, 0.15), (2, 0, 0.16), (4, 2, 0.18)]
)
def test_water_in_mass_and_tensor_is_named(body, axis, length):
    size = f"a cylinder of water of radius 20 mm and length {length * 1e3:.0f} mm"
    for whose, dry, numbers, i_link in (
        (OLD, OLD_MASS, OLD_INERTIA, False),
        (OLD, OLD_MASS, OLD_INERTIA_LINK, True),
        (NEW, reference.MASS, reference.INERTIA, False),
    ):
        for sign in (-1, +1):
            mass, wet = water_on(tensor(numbers[body], sign), axis, length, i_link)
            used = I_LINK if i_link else "I_COM"
            sign_of_products = f", {SOLIDWORKS}" if sign > 0 else ""
            words = f"{whose}, {used}{sign_of_products}"
            assert inertia_reason(body, wet, mass=dry[body] + mass) == (
                f"{words}, with the added inertia of {size} (strip theory)"
            )
            assert mass_reason(body, dry[body] + mass, wet) == (
                f"{whose.removesuffix(' numbers')} mass and the water's added mass, "
                f"{mass * 1e3:.0f} g, of {size}"
            )
            for factor in (0.9, 1.1):
                assert mass_reason(body, dry[body] + factor * mass, wet) is None


def test_each_wrong_mass_is_named():
    for body in range(5):
        water = {
            "an earlier revision's mass": OLD_MASS[body],
            "that of the whole arm": sum(reference.MASS),
            "the mass of Table 2": reference.MASS[body],
            "the mass of Table 2, in grams": reference.MASS[body] * 1e3,
        }
        for k in set(range(5)) - {body}:
            water[f"that of link_{k}"] = reference.MASS[k]
            water[f"an earlier revision's of link_{k}"] = OLD_MASS[k]
        for words, mass in water.items():
            assert mass_reason(body, mass) == words
    for body in (0, 2, 4):
        assert (
            mass_reason(body, reference.VOLUME[body]) == "that of the displaced water"
        )
    for rho in (1000, 1025):
        for body, whose, mass, volume, own in (
            (0, "Tables 2 and 3's", reference.MASS, reference.VOLUME, "its volume"),
            (0, "an earlier revision's", OLD_MASS, OLD_VOLUME, "its volume"),
            (
                0,
                "an earlier revision's",
                OLD_MASS,
                reference.VOLUME,
                "Table 3's volume",
            ),
        ):
            water = volume[body] * rho / 1e3
            assert mass_reason(body, mass[body] + water) == (
                f"{whose} mass and the water's added mass of {own}, {water * 1e3:.0f} g"
            )
    # half a gramme if grammes are written, a twentieth of one otherwise
    for mass, named in (
        (0.3414, False),
        (0.34104, True),
        (0.34106, False),
        (0.341, True),
    ):
        assert (mass_reason(0, mass) == "an earlier revision's mass") == named
    assert mass_reason(0, 0.5) is None


@pytest.mark.slow
def test_hardly_a_random_mass_is_named():
    """A mass is one number: some hypothesis fits by chance, but seldom."""
    rng = np.random.default_rng(0)
    for body in range(5):
        named = [
            mass_reason(body, m)
            for m in rng.uniform(0.5, 2.0, 200) * reference.MASS[body]
        ]
        assert sum(reason is not None for reason in named) <= 3


# ------------------------------------------------------------------------ solid bodies


def cylinder(mass, radius, length, axis):
    moments = np.full(3, mass * (3 * radius**2 + length**2) / 12)
    moments[axis] = mass * radius**2 / 2
    return np.diag(moments)


def box(mass, sides):
    squares = np.square(sides)
    return np.diag(mass / 12 * (squares.sum() - squares))


def test_solids_of_the_bodys_size_are_named():
    for axis in range(3):
        found = solid_of_size(LINKS[2], 0.4, cylinder(0.4, 0.019, 0.154, axis))
        assert found == "a solid cylinder of radius 19.0 mm and length 154.0 mm"
    # version 7's link 2 is 40 mm thick and 190.7 mm long
    for radius, length, named in (
        (0.0249, 0.15, True),
        (0.0251, 0.15, False),
        (0.02, 0.238, True),
        (0.02, 0.239, False),
    ):
        found = solid_of_size(LINKS[2], 0.4, cylinder(0.4, radius, length, 1))
        assert (found is not None) == named
    assert solid_of_size(LINKS[2], 0.4, box(0.4, (0.03, 0.04, 0.15))) == (
        "a solid box of 30 x 40 x 150 mm"
    )
    assert (
        solid_of_size(LINKS[2], 0.4, box(0.4, (0.03, 0.04, 0.25))) is None
    )  # too long
    assert (
        solid_of_size(LINKS[2], 0.4, box(0.4, (0.0302, 0.0413, 0.1507))) is None
    )  # no guess
    uneven = cylinder(0.4, 0.02, 0.15, 0) * np.diag([1, 1, 1.01])
    assert solid_of_size(LINKS[2], 0.4, uneven) is None
    tilt = ASTRAY[:3, :3]
    tilted = tilt @ cylinder(0.4, 0.02, 0.15, 0) @ tilt.T
    assert solid_of_size(LINKS[2], 0.4, tilted) == (
        "a solid cylinder of radius 20.0 mm and length 150.0 mm"
    )
    flat = cylinder(0.4, 0.02, 0.004, 0)
    assert "length 4.0 mm" in solid_of_size(LINKS[2], 0.4, flat)
    assert solid_of_size(LINKS[2], 0.4, np.diag([2e-4, 2e-4, 0.0])) is None
    assert solid_of_size(LINKS[2], -0.4, cylinder(-0.4, 0.02, 0.15, 0)) is None
    assert solid_of_size(LINKS[2], -0.4, cylinder(0.4, 0.02, 0.15, 0)) is None
    assert solid_of_size(LINKS[2], 0.0, cylinder(0.4, 0.02, 0.15, 0)) is None


def link(name, mass, inertia, com=(0, 0, 0), pose=HERE):
    return Inertial(name, mass, np.array(com, float), np.array(inertia, float), pose)


def test_guesses_are_named_link_by_link():
    guess = "a guess without products of inertia"
    one = link("a", 0.2, cylinder(0.2, 0.02, 0.1, 2))
    two = link("b", 0.05, box(0.05, (0.012, 0.03, 0.09)))
    three = link("c", 0.05, np.diag([1e-4, 1e-4, 1e-4]))
    four = link("d", 0.05, np.diag([1e-6, 2e-6, 2.5e-6]))
    dust = link("e", 0.0001, np.full((3, 3), 1e-4))
    rod = "a solid cylinder of radius 20.0 mm and length 100.0 mm"
    assert explain_guess(LINKS[4], [one]) == f"{guess}: {rod}"
    assert explain_guess(LINKS[4], [one, dust]) == f"{guess}: {rod}"
    assert explain_guess(LINKS[4], [one, two, three, four]) == (
        f"{guess}: a {rod}; b a solid box of 12 x 30 x 90 mm; "
        "c a dummy, 0.0001 kg m^2 about every axis"
    )
    assert explain_guess(LINKS[4], [four]) == guess
    full = link("f", 0.2, tensor(reference.INERTIA[0]))
    assert explain_guess(LINKS[4], [one, full]) is None
    assert explain_guess(LINKS[4], [full]) is None
    tilt = ASTRAY[:3, :3]
    tilted = link("g", 0.2, tilt @ one.inertia @ tilt.T)
    assert explain_guess(LINKS[4], [tilted]) == f"a guess: {rod}"
    assert explain_guess(LINKS[4], [tilted, four]) is None
    tilt = turned(1, 5e-5)  # rpy="0 1.57075 0"
    assert (
        explain_guess(LINKS[4], [link("h", 0.2, tilt @ one.inertia @ tilt.T)])
        == f"{guess}: {rod}"
    )
    odd = four.inertia.copy()
    for product, plain in ((0.9e-4, True), (1.1e-4, False)):
        odd[0, 1] = odd[1, 0] = product * 2.5e-6
        assert explain_guess(LINKS[4], [link("i", 0.05, odd)]) == (
            guess if plain else None
        )
