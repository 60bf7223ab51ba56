"""The inverse kinematics of an arm of one's own in JAX, CasADi, C and JavaScript."""

from __future__ import annotations

import ctypes
import dataclasses
import json
import shutil
import subprocess
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from own_arm import random_arm, tips, within

import alpha5_model as a5
from alpha5_model.codegen.c_library import COptions
from alpha5_model.kinematics.ik import Solutions
from alpha5_model.numbers.parameters import Alpha5Parameters

ON_AXIS = random_arm(np.random.default_rng(31), off_axis=False)
OFF_AXIS = random_arm(np.random.default_rng(32), off_axis=True)
ARMS = {"on the axis": ON_AXIS, "beside it": OFF_AXIS}
COUNT = 200
pytestmark = pytest.mark.tools


def targets(arm: Alpha5Parameters) -> tuple[np.ndarray, np.ndarray]:
    """Positions and wrists: reached ones, and some anywhere."""
    q = within(arm, COUNT, seed=1)
    position = tips(arm, q)
    rng = np.random.default_rng(2)
    position[::4] = rng.uniform(-0.6, 0.6, position[::4].shape)
    return position, q[:, 3].copy()


def agree(found: Any, expected: Solutions, tolerance: float) -> None:
    """q, exists, within_limits and singular are those expected."""
    q, exists, within_limits, singular = found
    np.testing.assert_allclose(q, expected.q, atol=tolerance)
    np.testing.assert_array_equal(np.asarray(exists) != 0, expected.exists)
    np.testing.assert_array_equal(
        np.asarray(within_limits) != 0, expected.within_limits
    )
    np.testing.assert_array_equal(np.asarray(singular) != 0, expected.singular)


def program_of(arm: Alpha5Parameters) -> Any:
    """The generated function with the arm's numbers."""
    pytest.importorskip("casadi")
    from alpha5_model.casadi import inverse_kinematics
    from alpha5_model.codegen.instructions import program

    return program(inverse_kinematics(arm))


@pytest.mark.parametrize("name", ARMS)
def test_casadi(name: str) -> None:
    pytest.importorskip("casadi")
    from alpha5_model.casadi import inverse_kinematics

    arm = ARMS[name]
    position, wrist = targets(arm)
    solve = inverse_kinematics(arm)
    assert solve.name() == "inverse_kinematics"
    assert "wrist: theta_3 [rad]" in str(solve.__doc__)
    q, exists, within_limits, singular = solve.map(COUNT)(position.T, wrist)
    rows = np.array(q).reshape(4, COUNT, 4).transpose(1, 0, 2)
    found = rows, np.array(exists).T, np.array(within_limits).T, np.array(singular)[0]
    agree(found, a5.inverse_kinematics(position, wrist, arm=arm), 1e-11)


def test_casadi_without_an_arm_is_the_catalogues() -> None:
    pytest.importorskip("casadi")
    from alpha5_model.casadi import inverse_kinematics

    q, *_ = inverse_kinematics()([0.2, -0.1, 0.1], 0.3)
    expected = a5.inverse_kinematics([0.2, -0.1, 0.1], 0.3).q
    np.testing.assert_allclose(np.array(q), expected, atol=1e-12)


def test_an_arm_with_its_own_limits_keeps_them_in_casadi() -> None:
    pytest.importorskip("casadi")
    from alpha5_model.casadi import load
    from alpha5_model.dynamics.load import arm_of

    record = a5.parameters()
    elbow = dataclasses.replace(record.joints[2], upper=1.0)
    joints = (*record.joints[:2], elbow, *record.joints[3:])
    own = dataclasses.replace(record, joints=joints)
    solve = load(arm_of(own)).inverse_kinematics
    position, wrist = targets(own)
    expected = a5.inverse_kinematics(position, wrist, arm=own)
    published = a5.inverse_kinematics(position, wrist)
    assert (expected.within_limits != published.within_limits).any()
    for i in range(40):
        _, _, within_limits, _ = solve(position[i], wrist[i])
        assert (np.array(within_limits)[:, 0] == expected.within_limits[i]).all()


@pytest.mark.parametrize("name", ARMS)
def test_jax_with_derivatives(name: str) -> None:
    jax = pytest.importorskip("jax")
    from alpha5_model.jax import inverse_kinematics

    arm = ARMS[name]
    position, wrist = targets(arm)
    expected = a5.inverse_kinematics(position, wrist, arm=arm)
    with jax.enable_x64(True):

        def solve(p: Any, w: Any) -> Any:
            return tuple(inverse_kinematics(p, w, arm=arm))

        found = jax.jit(jax.vmap(solve))(position, wrist)
        slopes = jax.jit(jax.vmap(jax.jacfwd(lambda p, w: solve(p, w)[0], (0, 1))))
        by_position, by_wrist = map(np.asarray, slopes(position, wrist))
    agree(found, expected, 1e-11)

    h = 1e-6
    for i, branch in np.argwhere(expected.exists)[:60]:
        q = expected.q[i, branch]
        steps = h * np.eye(4)
        jacobian = (tips(arm, q + steps) - tips(arm, q - steps)).T / (2 * h)
        slope = np.linalg.inv(jacobian[:, :3])
        scale = np.abs(slope).max()
        ours = by_position[i, branch, :3]
        np.testing.assert_allclose(ours, slope, atol=1e-5 * scale**2)
        # The tip stays where it is if theta_3 turns.
        turned = by_wrist[i, branch]
        assert turned[3] == pytest.approx(1.0)
        np.testing.assert_allclose(jacobian @ turned, 0.0, atol=1e-6 * scale)


def test_jax_in_single_precision() -> None:
    jax = pytest.importorskip("jax")
    from alpha5_model.jax import inverse_kinematics

    position, wrist = targets(OFF_AXIS)
    expected = a5.inverse_kinematics(position, wrist, arm=OFF_AXIS)
    with jax.enable_x64(False):
        found = jax.vmap(lambda p, w: inverse_kinematics(p, w, arm=OFF_AXIS))(
            position.astype(np.float32), wrist.astype(np.float32)
        )
    assert found.q.dtype == np.float32
    both = np.asarray(found.exists) & expected.exists
    assert (np.asarray(found.exists) == expected.exists).mean() > 0.99
    reached = tips(OFF_AXIS, np.asarray(found.q, np.float64))[both]
    wanted = np.broadcast_to(position[:, None], (COUNT, 4, 3))[both]
    assert np.abs(reached - wanted).max() < 1e-5


@pytest.mark.parametrize("name", ARMS)
@pytest.mark.parametrize("real", ["double", "float"])
def test_c(name: str, real: str, tmp_path: Path) -> None:
    if shutil.which("gcc") is None:
        pytest.skip("there is no gcc")
    from alpha5_model.codegen.c_library.header_and_source import header, source
    from alpha5_model.dynamics.load import arm_of

    record = ARMS[name]
    made = [program_of(record)]
    options = COptions(real=real)
    (tmp_path / "alpha5.h").write_text(header(arm_of(record), made, options))
    (tmp_path / "alpha5.c").write_text(source(arm_of(record), made, options))
    strict = ["-std=c99", "-pedantic", "-Wall", "-Wextra", "-Werror", "-O1"]
    build = ["gcc", *strict, "-shared", "-fPIC", "alpha5.c", "-lm", "-o", "own.so"]
    subprocess.run(build, cwd=tmp_path, check=True)
    solve = ctypes.CDLL(str(tmp_path / "own.so")).alpha5_inverse_kinematics
    number = ctypes.c_float if real == "float" else ctypes.c_double
    kind = np.dtype(number)

    position, wrist = targets(record)
    expected = a5.inverse_kinematics(position, wrist, arm=record)
    for i in range(40):
        p = position[i].astype(kind)
        q = np.empty((4, 4), kind)
        exists, within_limits = np.empty((2, 4), np.int32)
        singular = ctypes.c_int()
        outputs = [
            x.ctypes.data_as(ctypes.c_void_p) for x in (q, exists, within_limits)
        ]
        solve(
            p.ctypes.data_as(ctypes.c_void_p),
            number(wrist[i]),
            *outputs,
            ctypes.byref(singular),
        )
        if real == "double":
            found = q, exists, within_limits, singular.value
            one = Solutions._make(array[i] for array in expected)
            agree(found, one, 1e-11)
        reached = tips(record, q.astype(np.float64))[exists != 0]
        assert np.abs(reached - position[i]).max(initial=0.0) < (
            1e-14 if real == "double" else 2e-5
        )


@pytest.mark.parametrize("name", ARMS)
def test_javascript(name: str, tmp_path: Path) -> None:
    if shutil.which("node") is None:
        pytest.skip("there is no node")
    from alpha5_model.codegen.javascript_code import javascript

    arm = ARMS[name]
    position, wrist = targets(arm)
    script = javascript([program_of(arm)])
    given = json.dumps([[p, w] for p, w in zip(position.tolist(), wrist, strict=True)])
    script += (
        f"const answers = {given}.map(([p, w]) => inverse_kinematics(p, w));\n"
        "console.log(JSON.stringify(answers));\n"
    )
    (tmp_path / "solve.mjs").write_text(script)
    done = subprocess.run(
        ["node", "solve.mjs"], cwd=tmp_path, check=True, capture_output=True, text=True
    )
    answers = json.loads(done.stdout)
    q = np.array([answer["q"] for answer in answers], np.float64)  # null is NaN
    flags = [
        np.array([answer[flag] for answer in answers], np.float64)
        for flag in ("exists", "within_limits", "singular")
    ]
    agree((q, *flags), a5.inverse_kinematics(position, wrist, arm=arm), 1e-11)
