"""Each key of an arm file, changed alone, changes dynamics, code and kinematics."""

from __future__ import annotations

import re
from typing import Any

import numpy as np
import pytest
from arm_keys import WHOLE, changes

import alpha5_model as a5
from alpha5_model.codegen.c_library import COptions, c_files
from alpha5_model.numbers.parameters import Alpha5Parameters

jax = pytest.importorskip("jax")

Q = np.array([2.9, 1.1, 1.7, 2.0])
V = np.array([0.3, -0.2, 0.4, 0.5])
A = np.array([0.5, 0.4, -0.3, 0.2])
TARGETS = np.random.default_rng(2).uniform(-0.35, 0.35, (60, 3))
#: All of them; what is not listed has its limits or motors elsewhere.
DYNAMICS = {"arm", "afloat", "kernels", "jax", "c"}


def is_left_out(key: str) -> bool:
    """One joint's motors are enough, and the code has no jaws."""
    if key.startswith("motors."):
        return key.endswith(("_d", "_c", "_b", "_a"))
    return key.startswith("joint_limits.axis_a")


KEYS = {key: text for key, text in changes(WHOLE) if not is_left_out(key)}
#: At the ends of axis_b's range, and between.
WRISTS = np.resize([0.05, 2.0, 6.2], len(TARGETS))


def answers(arm: Alpha5Parameters) -> dict[str, Any]:
    """What each product says of an arm, as bytes."""
    loaded = a5.load(arm=arm)
    afloat = a5.load(arm=arm, floating_base=True)
    root = np.array([0.0, 0.0, 0.0, 0.1, 0.5, 0.1, np.sqrt(1 - 0.27)])
    by_kernels = a5.load(arm=arm, backend="kernels")
    solved = a5.inverse_kinematics(TARGETS, WRISTS, arm=arm)
    motors = [
        a5.actuators.actuator(name, screw_lead=1e-3, arm=arm)
        for name in by_kernels.joint_names
    ]
    c = c_files(COptions(arm=arm))
    code = c["alpha5.c"] + c["test_alpha5.c"]
    return {
        "arm": _bytes(
            loaded.inverse_dynamics(Q, V, A),
            loaded.base_wrench(Q, V, A).vector,
            loaded.forward_kinematics(Q).homogeneous,
        ),
        "afloat": _bytes(
            afloat.mass_matrix(np.r_[root, Q]),
            afloat.buoyancy_torque(np.r_[root, Q]),
            afloat.forward_kinematics(np.r_[root, Q]).homogeneous,
        ),
        "kernels": _bytes(
            by_kernels.inverse_dynamics(Q, V, A),
            by_kernels.base_wrench(Q, V, A).vector,
            by_kernels.jacobian(Q),
        ),
        "jax": _of_jax(loaded),
        "c": re.sub(rb"/\*.*?\*/", b"", code, flags=re.DOTALL),
        "limits": _bytes(*loaded.limits),
        "ik": _bytes(solved.q, solved.within_limits),
        "motors": _bytes(*(_motor(motor) for motor in motors)),
    }


def _bytes(*arrays: Any) -> bytes:
    # Adding zero turns negative zeros into zeros.
    rounded = [np.round(np.asarray(x, float), 12) + 0.0 for x in arrays]
    return b"".join(x.tobytes() for x in rounded)


def _of_jax(loaded: a5.Arm) -> bytes:
    from alpha5_model.jax import load

    with jax.enable_x64(True):
        arm = load(loaded)
        held = arm.with_payload(0.3, (0.01, 0.02, 0.03))
        return _bytes(
            arm.inverse_dynamics(Q, V, A),
            arm.base_wrench(Q, V, A),
            arm.forward_kinematics(Q),
            held.inverse_dynamics(Q, V, A),
        )


def _motor(motor: a5.actuators.Actuator) -> np.ndarray:
    turning = None if motor.rotor_inertia is None else 2.0
    current = motor.current(0.5, 0.2, turning)
    ends = motor.current_interval(0.5, 0.2, turning)
    voltage = motor.voltage(current, 0.2, 3.0)
    backward = motor.current(-0.5, -0.2, turning and -turning)
    return np.array([current, *ends, voltage, backward])


def concerned(key: str) -> set[str]:
    """The products that a key concerns."""
    table, _, name = key.partition(".")
    if table in ("name", "attached") and "name" in key:
        return set()
    if table == "motors":
        # Supply and current limit bound a trajectory, not one state.
        is_of_drive = name.startswith(("supply_voltage", "current_limit"))
        return set() if is_of_drive else {"motors"}
    if table == "mount":
        # A mount turns gravity for a fixed base.
        return DYNAMICS - {"afloat"} if name == "rpy" else set()
    if table == "joint_limits":
        return _concerned_by_limit(name)
    if key == "zeros.axis_b":
        return DYNAMICS  # a tool on the wrist axis stays where it is
    if table in ("lengths", "zeros") or key in ("attached.spacer", "tool.xyz"):
        return DYNAMICS | {"ik"}
    if key == "tool.rpy":
        return DYNAMICS - {"kernels"}  # whose Jacobian is in base_link
    if table == "corrections":
        return DYNAMICS
    if key.startswith("links.link_0.") and name.endswith("inertia"):
        return {"afloat"}  # a fixed base does not turn link_0
    return DYNAMICS


def _concerned_by_limit(name: str) -> set[str]:
    return {"limits", "c", "ik"} if name.endswith("position") else {"limits"}


@pytest.fixture(scope="module")
def arm_of_text(tmp_path_factory: pytest.TempPathFactory) -> Any:
    file = tmp_path_factory.mktemp("arms") / "my_arm.toml"

    def read(text: str) -> Alpha5Parameters:
        file.write_text(f"format = 1\n{text}", encoding="utf-8")
        return a5.arm_file(file)

    return read


@pytest.fixture(scope="module")
def defaults(arm_of_text: Any) -> dict[str, dict[str, Any]]:
    """With and without an attached body: the answers of an unchanged file."""
    return {text: answers(arm_of_text(text)) for text in ("", WHOLE)}


@pytest.mark.slow
@pytest.mark.filterwarnings("ignore::alpha5_model.errors.ImplausibleWarning")
@pytest.mark.parametrize("key", KEYS)
def test_each_key_alone_changes_what_it_concerns(
    key: str, arm_of_text: Any, defaults: dict[str, dict[str, Any]]
) -> None:
    before = defaults[WHOLE if key.startswith("attached.") else ""]
    after = answers(arm_of_text(KEYS[key]))
    changed = {name for name in after if after[name] != before[name]}
    assert changed == concerned(key)
