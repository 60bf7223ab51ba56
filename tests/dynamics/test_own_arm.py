"""`load` of an arm's record against Newton and Euler from the same record."""

from __future__ import annotations

import dataclasses
from pathlib import Path

import numpy as np
import own_arm_dynamics as own
import pinocchio as pin
import pytest
from compiled_kernels import compiled_kernels
from loops import each

import alpha5_model as a5
from alpha5_model._support.paths import JAWS_URDF_PATH, URDF_PATH
from alpha5_model.description.reading import parse_urdf
from alpha5_model.description.urdf import Variant, urdf
from alpha5_model.dynamics.batch import frame_positions
from alpha5_model.dynamics.load import arm_of, arm_urdf
from alpha5_model.errors import InputError
from alpha5_model.kernels import choice as kernels
from alpha5_model.kernels import numpy_kernels
from alpha5_model.numbers.parameters import Alpha5Parameters

GRAVITY = np.array([0.0, 0.0, -9.81])
DENSITY = 1025.0
RECORDS = own.RECORDS
#: With a spacer, a tool beside the wrist axis, the other base frame, and a mount.
every_record = each("record", [RECORDS[k] for k in (1, 2, 8, 9)])


def gravity_at_base(record: Alpha5Parameters) -> np.ndarray:
    return GRAVITY if record.mount is None else GRAVITY @ record.mount.rotation


@every_record
def test_torques_loads_masses_and_poses_are_those_of_the_record(
    record: Alpha5Parameters,
) -> None:
    arm = a5.load(DENSITY, arm=record)
    q, v, a = own.states(record, 20)
    torque, load = own.inverse_dynamics(
        record, q, v, a, DENSITY, gravity_at_base(record)
    )

    assert arm.inverse_dynamics_batch(q, v, a) == pytest.approx(torque, abs=1e-11)
    assert arm.base_wrench_batch(q, v, a) == pytest.approx(load, abs=1e-11)
    for k in range(5):
        single = arm.inverse_dynamics(q[k], v[k], a[k])
        assert single == pytest.approx(torque[k], abs=1e-11)
        masses = arm.mass_matrix(q[k])
        assert masses == pytest.approx(own.mass_matrix(record, q[k]), abs=1e-12)
        tip = arm.forward_kinematics(q[k]).homogeneous
        assert tip == pytest.approx(own.tcp(record, q[k]), abs=1e-13)
    assert arm.parameters is record


@every_record
def test_limits_are_those_of_the_record(record: Alpha5Parameters) -> None:
    arm = a5.load(gripper="jaws", arm=record)
    expected = [
        [getattr(joint, end) for joint in record.joints]
        for end in ("lower", "upper", "velocity", "effort")
    ]
    assert np.array_equal(np.array(arm.limits), expected)


@every_record
def test_closed_jaws_and_a_resting_vehicle_change_no_torque(
    record: Alpha5Parameters,
) -> None:
    level = dataclasses.replace(record, mount=None)
    q, v, a = own.states(level, 4)
    torque, _ = own.inverse_dynamics(level, q, v, a, DENSITY, GRAVITY)
    jaws = a5.load(DENSITY, gripper="jaws", arm=level)
    afloat = a5.load(DENSITY, floating_base=True, arm=record)
    closed = np.full((4, 1), record.joints[4].lower)
    still = np.zeros((4, 1))
    with_jaws = jaws.inverse_dynamics_batch(
        np.hstack([q, closed]), np.hstack([v, still]), np.hstack([a, still])
    )
    assert with_jaws[:, :4] == pytest.approx(torque, abs=1e-11)

    root = pin.neutral(afloat.model)[:7]
    at_rest = np.zeros(6)
    for k in range(4):
        whole = afloat.inverse_dynamics(
            np.r_[root, q[k]], np.r_[at_rest, v[k]], np.r_[at_rest, a[k]]
        )
        assert whole[6:] == pytest.approx(torque[k], abs=1e-11)


@every_record
def test_the_quick_way_makes_the_same_arm(record: Alpha5Parameters) -> None:
    quick = arm_of(record, DENSITY, gravity_at_base(record))
    arm = a5.load(DENSITY, arm=record)
    q, v, a = own.states(record, 5)
    expected = arm.inverse_dynamics_batch(q, v, a)
    assert quick.inverse_dynamics_batch(q, v, a) == pytest.approx(expected, abs=1e-11)
    tip = quick.forward_kinematics(q[0]).homogeneous
    assert tip == pytest.approx(arm.forward_kinematics(q[0]).homogeneous, abs=1e-13)


def test_a_payload_adds_its_weight_at_the_records_tool() -> None:
    record = RECORDS[2]
    bare = a5.load(0.0, arm=record)
    loaded = bare.with_payload(0.3)
    q, _, _ = own.states(record, 1)
    force = np.zeros(6)
    force[2] = 0.3 * 9.81
    tip = pin.ReferenceFrame.LOCAL_WORLD_ALIGNED
    data = bare.model.createData()
    frame = bare.model.getFrameId("tcp")
    jacobian = pin.computeFrameJacobian(bare.model, data, q[0], frame, tip)
    added = loaded.gravity_torque(q[0]) - bare.gravity_torque(q[0])
    assert added == pytest.approx(jacobian.T @ force, abs=1e-11)
    assert loaded.parameters is record


@pytest.mark.parametrize("module", ["compiled", "numpy"])
@every_record
def test_the_kernels_know_the_record(
    record: Alpha5Parameters, module: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    chosen = numpy_kernels if module == "numpy" else compiled_kernels()
    monkeypatch.setattr(kernels, "module", lambda: chosen)
    fast = a5.load(DENSITY, arm=record)
    q, v, a = own.states(record, 30)
    torque, load = own.inverse_dynamics(
        record, q, v, a, DENSITY, gravity_at_base(record)
    )
    assert fast.inverse_dynamics_batch(q, v, a) == pytest.approx(torque, abs=1e-11)
    assert fast.base_wrench_batch(q, v, a) == pytest.approx(load, abs=1e-11)
    assert fast.forward_dynamics_batch(q, v, torque) == pytest.approx(a, abs=1e-9)
    regressor = fast.regressor(q, v, a)
    assert regressor.matrix @ regressor.parameters == pytest.approx(torque, abs=1e-11)
    tips = [own.tcp(record, row)[:3, 3] for row in q]
    assert frame_positions(fast, q) == pytest.approx(np.array(tips), abs=1e-14)


def test_a_model_that_is_not_its_records_stays_on_pinocchio() -> None:
    record = RECORDS[2]
    arm = a5.load(arm=record)
    model = arm.model
    model.jointPlacements[3].translation[0] += 1e-6
    other = a5.Arm(model, arm.displacements, parameters=record)
    assert other._kernel_parameters is None
    with pytest.raises(InputError, match=r"the dimensions of its record, .*axis_c"):
        other.regressor(*(x[0] for x in own.states(record, 1)))


def test_a_row_that_no_arm_file_has_stays_on_pinocchio() -> None:
    """The equations have no d_1; the model is not changed for it."""
    record = RECORDS[2]
    rows = list(record.dh)
    rows[1] = dataclasses.replace(rows[1], d=0.01)
    odd = dataclasses.replace(record, dh=tuple(rows))
    arm = arm_of(odd, DENSITY)
    assert arm._kernel_parameters is None
    q, v, a = own.states(odd, 5)
    torque, _ = own.inverse_dynamics(odd, q, v, a, DENSITY, GRAVITY)
    assert arm.inverse_dynamics_batch(q, v, a) == pytest.approx(torque, abs=1e-11)


def test_a_mount_is_the_parent_in_the_urdf_and_tilts_gravity_in_load() -> None:
    record = RECORDS[9]
    assert record.mount is not None
    robot = parse_urdf(urdf(Variant(arm=record)))
    mount = robot.joints["mount"]
    assert (mount.parent, mount.child) == ("bluerov", "base_link")
    model = pin.buildModelFromXML(urdf(Variant(arm=record)))
    place = model.frames[model.getFrameId("base_link")].placement
    assert place.translation == pytest.approx(record.mount.position, abs=1e-15)
    assert place.rotation == pytest.approx(record.mount.rotation, abs=1e-12)

    down = a5.load(arm=record).model.gravity.linear
    assert down == pytest.approx(record.mount.rotation.T @ GRAVITY)
    chosen = parse_urdf(urdf(Variant(arm=record, parent="table")))
    assert chosen.joints["mount"].parent == "table"


def test_the_urdf_has_the_arms_name_and_says_that_it_is_changed() -> None:
    text = urdf(Variant(arm=RECORDS[1]))
    assert '<robot name="lab_1"' in text
    assert "changed for the arm lab_1" in text
    assert "changed for" not in urdf(Variant(corrections=()))


def test_a_spacer_moves_the_fingers_of_drawing_and_collision() -> None:
    record = RECORDS[1]
    ours = parse_urdf(urdf())
    theirs = parse_urdf(urdf(Variant(arm=record)))

    def shapes(text: str) -> list[float]:
        model = pin.buildModelFromXML(text)
        bodies = pin.buildGeomFromUrdfString(
            model, text, pin.GeometryType.COLLISION, package_dirs=["urdf"]
        )
        wrist = model.frames[model.getFrameId("link_4")].placement.inverse()
        return [
            float((wrist * body.placement).translation[2])
            for body in bodies.geometryObjects
            if body.name.startswith("link_4")
        ]

    moved = np.subtract(shapes(urdf()), shapes(urdf(Variant(arm=record))))
    assert np.count_nonzero(np.abs(moved) < 1e-9) == 1, "the wrist itself stays"
    fingers = moved[np.abs(moved) > 1e-9]
    assert fingers == pytest.approx(np.full(len(fingers), record.spacer), abs=1e-6)
    assert ours.links.keys() == theirs.links.keys()


def test_corrections_beside_an_arm_are_refused_unless_its_own() -> None:
    record = RECORDS[8]
    message = r"no corrections beside an arm, which has its own \(none\)"
    for call in (a5.load, a5.robot_wrapper):
        with pytest.raises(InputError, match=message):
            call(arm=record, corrections=("link3_cob",))
    with pytest.raises(InputError, match=message):
        Variant(arm=record, corrections=("link3_cob",))
    assert a5.load(arm=record, corrections=()).parameters is record
    with pytest.raises(InputError, match=r"an Alpha5Parameters, as .*arm_file\(FILE\)"):
        a5.load(arm="my_arm.toml")  # type: ignore[arg-type]
    with pytest.raises(InputError, match="expected an Alpha5Parameters, got 3"):
        a5.load(arm=3)  # type: ignore[arg-type]


def test_the_catalogues_record_is_the_shipped_urdf() -> None:
    q, v, a = own.states(a5.parameters(), 5)
    expected = a5.load().inverse_dynamics_batch(q, v, a)
    found = a5.load(arm=a5.parameters()).inverse_dynamics_batch(q, v, a)
    assert np.array_equal(found, expected)
    assert urdf(Variant(arm=a5.parameters())) == urdf()
    moved = a5.robot_wrapper(arm=RECORDS[2])
    q0 = q[0]
    pin.framesForwardKinematics(moved.model, moved.data, q0)
    tip = moved.data.oMf[moved.model.getFrameId("tcp")].homogeneous
    assert tip == pytest.approx(own.tcp(RECORDS[2], q0), abs=1e-13)


def test_only_the_catalogues_default_is_the_shipped_file() -> None:
    for gripper, path in (("locked", URDF_PATH), ("jaws", JAWS_URDF_PATH)):
        shipped = Path(path).read_text("utf-8")
        assert arm_urdf(gripper, a5.parameters()) == shipped
        letter = arm_urdf(gripper, a5.parameters(()))
        assert letter == urdf(Variant(gripper=gripper, corrections=()))
        assert letter != shipped
