"""Inertia conversions agree with sums over points; impossible bodies are found."""

from __future__ import annotations

import contextlib
from typing import Any

import numpy as np
import pytest
import reference
from hypothesis import assume, given, settings
from hypothesis import strategies as st

import alpha5_model as a5
from alpha5_model.errors import Alpha5Error, InputError, ShapeError
from alpha5_model.numbers import inertia as mod

seeds = st.integers(0, 2**32 - 1)


class Cloud:
    """Point masses: by definition, every inertial quantity is a plain sum over them."""

    def __init__(self, seed: int, count: int = 12) -> None:
        rng = np.random.default_rng(seed)
        self.m = rng.uniform(0.01, 1.0, count)
        spread = rng.normal(size=(count, 3)) * rng.uniform(0.01, 0.3, 3)
        self.p = spread + rng.normal(size=3)

    mass = property(lambda self: float(self.m.sum()))
    com = property(lambda self: (self.m @ self.p) / self.m.sum())

    def tensor(self, about: Any = (0.0, 0.0, 0.0)) -> np.ndarray:
        """Textbook integrals: y^2 + z^2 on the diagonal, -x y beside it."""
        out = np.zeros((3, 3))
        for m, (x, y, z) in zip(self.m, self.p - np.asarray(about), strict=True):
            out += m * np.array(
                [
                    [y * y + z * z, -x * y, -x * z],
                    [-x * y, x * x + z * z, -y * z],
                    [-x * z, -y * z, x * x + y * y],
                ]
            )
        return out


def rotation(seed: int) -> np.ndarray:
    q, r = np.linalg.qr(np.random.default_rng(seed).normal(size=(3, 3)))
    q = q * np.sign(np.diag(r))
    return q * np.linalg.det(q)


# --- conversions ----------------------------------------------------------------------


@given(seeds)
def test_flip_products_against_solidworks_definition(seed: int) -> None:
    cloud = Cloud(seed)
    x, y, z = cloud.p.T
    solidworks = np.diag(np.diag(cloud.tensor()))
    for i, j, product in ((0, 1, x * y), (0, 2, x * z), (1, 2, y * z)):
        solidworks[i, j] = solidworks[j, i] = cloud.m @ product
    np.testing.assert_allclose(
        mod.flip_products(solidworks), cloud.tensor(), rtol=1e-12
    )
    np.testing.assert_array_equal(
        mod.flip_products(mod.flip_products(solidworks)), solidworks
    )
    # As a control, the sign matters.
    assert np.abs(solidworks - cloud.tensor()).max() > 1e-6


@given(seeds)
def test_parallel_axis_both_ways(seed: int) -> None:
    cloud = Cloud(seed)
    at_com = cloud.tensor(cloud.com)
    at_origin = cloud.tensor()
    size = np.abs(at_origin).max()
    there = mod.tensor_at_origin(cloud.mass, cloud.com, at_com)
    back = mod.tensor_at_com(cloud.mass, cloud.com, at_origin)
    np.testing.assert_allclose(there, at_origin, rtol=0, atol=1e-13 * size)
    np.testing.assert_allclose(back, at_com, rtol=0, atol=1e-13 * size)
    # The control: the sign that equation (2) prints is off by twice the term.
    assume(np.linalg.norm(cloud.com) > 0.1)
    wrong = at_com - mod.point_mass_tensor(cloud.mass, cloud.com)
    assert np.abs(wrong - at_origin).max() > 0.01 * size


@given(seeds, seeds)
def test_rotation_of_a_tensor(seed: int, turn: int) -> None:
    cloud = Cloud(seed)
    r = rotation(turn)
    turned = Cloud(seed)
    turned.p = cloud.p @ r.T
    size = np.abs(cloud.tensor()).max()
    np.testing.assert_allclose(
        mod.rotate_tensor(r, cloud.tensor()), turned.tensor(), rtol=0, atol=1e-13 * size
    )


@given(seeds)
def test_second_moments_and_pseudo_inertia(seed: int) -> None:
    cloud = Cloud(seed)
    homogeneous = np.column_stack([cloud.p, np.ones(len(cloud.m))])
    by_definition = (cloud.m * homogeneous.T) @ homogeneous
    pseudo = mod.pseudo_inertia(cloud.mass, cloud.com, cloud.tensor(cloud.com))
    np.testing.assert_allclose(pseudo, by_definition, rtol=0, atol=1e-12 * pseudo.max())
    np.testing.assert_allclose(
        mod.second_moments(cloud.tensor()),
        by_definition[:3, :3],
        rtol=0,
        atol=1e-12 * pseudo.max(),
    )


@settings(deadline=None)  # the first example imports Pinocchio
@given(seeds)
def test_pinocchio_agrees(seed: int) -> None:
    pin = pytest.importorskip("pinocchio")
    cloud = Cloud(seed)
    body = pin.Inertia(cloud.mass, cloud.com, cloud.tensor(cloud.com))
    at_origin = mod.tensor_at_origin(cloud.mass, cloud.com, cloud.tensor(cloud.com))
    np.testing.assert_allclose(body.matrix()[3:, 3:], at_origin, rtol=1e-12, atol=1e-12)
    r = rotation(seed)
    turned = pin.SE3(r, np.zeros(3)).act(body)
    np.testing.assert_allclose(
        turned.inertia, mod.rotate_tensor(r, body.inertia), rtol=1e-12, atol=1e-14
    )


@given(seeds)
def test_combine_joins_and_takes_out(seed: int) -> None:
    a = Cloud(seed)
    b = Cloud(seed + 1)
    whole = Cloud(seed)
    whole.m = np.concatenate([a.m, b.m])
    whole.p = np.vstack([a.p, b.p])
    mass, com, tensor = mod.combine(
        [a.mass, b.mass], [a.com, b.com], [a.tensor(a.com), b.tensor(b.com)]
    )
    assert mass == pytest.approx(whole.mass, rel=1e-14)
    np.testing.assert_allclose(com, whole.com, atol=1e-13)
    np.testing.assert_allclose(tensor, whole.tensor(whole.com), atol=1e-11)
    mass, com, rest = mod.combine(
        [mass, -b.mass], [com, b.com], [tensor, -b.tensor(b.com)]
    )
    np.testing.assert_allclose(com, a.com, atol=1e-11)
    np.testing.assert_allclose(rest, a.tensor(a.com), atol=1e-10)


def test_arguments_are_left_alone_and_checked() -> None:
    tensor = np.arange(9.0).reshape(3, 3)
    kept = tensor.copy()
    mod.flip_products(tensor)
    mod.rotate_tensor(np.eye(3), tensor)
    np.testing.assert_array_equal(tensor, kept)
    with pytest.raises(ShapeError, match=r"shape \(\.\.\., 3, 3\)"):
        mod.flip_products(np.eye(4))
    with pytest.raises(Alpha5Error, match=r"com\[1\]"):
        mod.inconsistencies(1.0, [0, np.nan, 0], np.eye(3))
    with pytest.raises(InputError, match="add up to zero"):
        mod.combine([1.0, -1.0], np.zeros((2, 3)), np.zeros((2, 3, 3)))


ONE = np.ones(())
THREE = np.zeros(3)
TENSOR = np.eye(3)
BODY = {"mass": ONE, "com": THREE, "inertia_com": TENSOR}
#: Every function with arguments that fit.
CALLS = {
    "flip_products": {"inertia": TENSOR},
    "point_mass_tensor": {"mass": ONE, "position": THREE},
    "tensor_at_origin": BODY,
    "tensor_at_com": {"mass": ONE, "com": THREE, "inertia_origin": TENSOR},
    "rotate_tensor": {"rotation_a_to_b": TENSOR, "inertia": TENSOR},
    "combine": {
        "masses": np.ones(2),
        "coms": np.zeros((2, 3)),
        "inertias": np.array([TENSOR, TENSOR]),
    },
    "second_moments": {"inertia": TENSOR},
    "pseudo_inertia": BODY,
    "principal_moments": {"inertia": TENSOR},
    "inconsistencies": BODY | {"bounds": np.array([[-1.0, 1.0]] * 3), "tolerance": 0.0},
}


@pytest.mark.parametrize("name", CALLS)
def test_wrong_shapes_and_numbers_are_errors_of_the_package(name: str) -> None:
    function = getattr(mod, name)
    given = CALLS[name]
    function(**given)
    wrong = [None, "abc", {}, [[1], [1, 2]], 1j, np.ma.masked_array([1.0], mask=[True])]
    for argument, value in given.items():
        shape = np.shape(value)
        shapes = [(4,), (2, 4), (5, 3), (3, 4), (4, 3, 3), (3, 3, 3, 2)]
        others = {k: np.array([v, v]) for k, v in given.items() if k != argument}
        for bad in [*wrong, np.full(shape, np.nan), *(np.ones(s) for s in shapes)]:
            for call in (given | {argument: bad}, others | {argument: bad}):
                # Leading axes that fit are no error. A raw NumPy error fails the test.
                with contextlib.suppress(Alpha5Error):
                    function(**call)
                    assert isinstance(bad, np.ndarray) or argument == "bounds"
                    assert bad is None or np.isfinite(bad).all()
        multiplied = argument != "tolerance" and name != "flip_products"
        if multiplied:
            with pytest.raises(InputError):
                function(**(given | {argument: np.full(shape, 1e200)}))


def test_leading_shapes_must_fit_one_another() -> None:
    two = np.ones(2)
    three = np.ones(3)
    for call in (
        lambda: mod.point_mass_tensor(two, np.zeros((3, 3))),
        lambda: mod.tensor_at_origin(two, np.zeros(3), np.zeros((3, 3, 3))),
        lambda: mod.tensor_at_com(two, np.zeros((3, 3)), np.zeros((3, 3))),
        lambda: mod.rotate_tensor(np.array([np.eye(3)] * 2), np.zeros((3, 3, 3))),
        lambda: mod.pseudo_inertia(three, np.zeros((2, 3)), np.eye(3)),
    ):
        with pytest.raises(ShapeError, match="leading shapes that broadcast"):
            call()
    bodies = two, np.zeros((2, 3)), np.zeros((2, 3, 3))
    mod.combine(*bodies)
    for i, shapes in enumerate(
        (
            [(), (1, 2), (3,)],
            [(3,), (1, 3), (3, 3), (1, 2, 3)],
            [(3, 3), (1, 3, 3), (3, 3, 3), (1, 2, 3, 3)],
        )
    ):
        for shape in shapes:
            with pytest.raises(ShapeError):
                mod.combine(*bodies[:i], np.ones(shape), *bodies[i + 1 :])
    with pytest.raises(ShapeError, match=r"shape \(3,\)"):
        mod.inconsistencies(1.0, np.zeros((2, 3)), np.eye(3))
    with pytest.raises(ShapeError, match=r"shape \(3, 2\)"):
        mod.inconsistencies(1.0, np.zeros(3), np.eye(3), np.zeros((2, 3, 2)))


# --- physical consistency -------------------------------------------------------------


@settings(max_examples=200)
@given(seeds)
def test_a_real_body_is_consistent(seed: int) -> None:
    cloud = Cloud(seed)
    bounds = np.column_stack([cloud.p.min(axis=0), cloud.p.max(axis=0)])
    assert (
        mod.inconsistencies(
            cloud.mass, cloud.com, cloud.tensor(cloud.com), bounds, 1e-9
        )
        == ()
    )


@given(seeds, st.floats(1.02, 10.0))
def test_the_triangle_inequality_is_enforced(seed: int, factor: float) -> None:
    r = rotation(seed)
    a, b = np.random.default_rng(seed).uniform(0.1, 1.0, 2)
    tensor = mod.rotate_tensor(r, np.diag([a, b, (a + b) * factor]))
    (found,) = mod.inconsistencies(1.0, [0, 0, 0], (tensor + tensor.T) / 2)
    assert "exceeds the sum of the others" in found
    # The same statement in the other form of [Wensing2018]: a negative second moment.
    assert np.linalg.eigvalsh(mod.second_moments(tensor))[0] < 0
    assert np.linalg.eigvalsh(mod.pseudo_inertia(1.0, np.zeros(3), tensor))[0] < 0


CUBE = np.eye(3) / 6 * 0.1**2
BOX = np.array([[-0.05, 0.05]] * 3)
IMPOSSIBLE = {
    "is not positive": (-1.0, np.zeros(3), CUBE, None),
    "is not symmetric": (
        1.0,
        np.zeros(3),
        CUBE + np.triu(np.full((3, 3), 1e-4), 1),
        None,
    ),
    "smallest principal moment": (1.0, np.zeros(3), CUBE * [1, 1, -1], None),
    "COM's y = 60.0 mm is outside": (1.0, np.array([0, 0.06, 0]), CUBE, BOX),
    "spreads 50.9 mm along x, more than a body of this size can, 50.0 mm": (
        1.0,
        np.zeros(3),
        2 * 0.05**2 * 1.036 * np.eye(3),
        BOX,
    ),
}


@pytest.mark.parametrize("words", IMPOSSIBLE)
def test_impossible_bodies_are_named(words: str) -> None:
    mass, com, tensor, bounds = IMPOSSIBLE[words]
    found = mod.inconsistencies(mass, com, tensor, bounds)
    assert any(words in sentence for sentence in found), found
    assert mod.inconsistencies(1.0, np.zeros(3), CUBE, BOX) == ()


def test_a_body_without_mass_is_only_that() -> None:
    found = mod.inconsistencies(0.0, np.zeros(3), CUBE, BOX)
    assert found == ("mass 0 kg is not positive",)


@pytest.mark.parametrize("i", range(5))
def test_the_arm_is_consistent(i: int) -> None:
    link = a5.parameters().links[i]
    assert mod.inconsistencies(link.mass, link.com, link.inertia) == ()
    found = mod.inconsistencies(link.mass, link.com, link.inertia, link.bounds)
    if i != 1:
        assert found == ()
        return
    # Table 2's link 1 is longer than its visible part: some of its mass turns inside
    # link 0's hub. From the printed digits, the spread is sqrt((Ixx + Iyy - Izz) / 2m).
    xx, yy, zz, *_ = reference.INERTIA[1]
    spread = np.sqrt((xx + yy - zz) / 2 / reference.MASS[1])
    height = reference.COM[1][2]
    assert spread > np.sqrt((67 - height) * (height - 14))
    assert len(found) == 1
    assert f"the mass spreads {spread:.1f} mm along z" in found[0]


def test_size_finds_what_the_triangle_inequality_cannot() -> None:
    """I_Link instead of I_COM, or a COM in another frame, has a consistent tensor."""
    link = a5.parameters().links[4]
    at_origin = mod.tensor_at_origin(link.mass, link.com, link.inertia)
    assert mod.inconsistencies(link.mass, link.com, at_origin) == ()
    found = mod.inconsistencies(link.mass, link.com, at_origin, link.bounds)
    assert any("spreads" in text for text in found)
    wrong = link.com + np.array([0, 0, 0.0982])
    assert mod.inconsistencies(link.mass, wrong, link.inertia) == ()
    found = mod.inconsistencies(link.mass, wrong, link.inertia, link.bounds)
    assert any("outside" in text for text in found)
