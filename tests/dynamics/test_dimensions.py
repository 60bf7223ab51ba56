"""How far the joints, the tcp and the limits of a model may be from a record's."""

from __future__ import annotations

from collections.abc import Callable

import pinocchio as pin
import pytest
from loops import each

import alpha5_model as a5
from alpha5_model.description.urdf import Variant, urdf
from alpha5_model.dynamics.dimensions import (
    DRAWN,
    EXACT,
    check_dimensions,
    check_limits,
    has_dimensions,
)
from alpha5_model.errors import InputError

ARM = a5.parameters()


def moved(joint: int, by: float, axis: int = 0) -> pin.Model:
    """The catalogue's model with a joint that is moved along an axis of its place."""
    model = a5.load().model
    model.jointPlacements[joint].translation[axis] += by
    return model


def with_tcp(by: float) -> pin.Model:
    model = a5.load().model
    model.frames[model.getFrameId("tcp")].placement.translation[2] += by
    return model


#: A change by something times the tolerance.
CHANGES: dict[str, Callable[[float], pin.Model]] = {
    "axis_e": lambda by: moved(1, by, axis=2),
    "axis_d": lambda by: moved(2, by),
    "axis_c": lambda by: moved(3, -by, axis=1),
    "axis_b": lambda by: moved(4, by, axis=2),
    "tcp": with_tcp,
}


@each("name", CHANGES)
@each("tolerance", [EXACT, DRAWN])
def test_a_model_may_be_off_by_the_tolerance(name: str, tolerance: float) -> None:
    near = CHANGES[name](0.99 * tolerance)
    far = CHANGES[name](1.01 * tolerance)
    assert has_dimensions(near, tolerance)
    assert not has_dimensions(far, tolerance)
    check_dimensions(near, "this", tolerance)
    with pytest.raises(InputError, match=f"got '{name} .* mm off'"):
        check_dimensions(far, "this", tolerance)


def test_where_the_base_is_does_not_matter() -> None:
    mounted = Variant(parent="vehicle", xyz=(0.3, -0.1, 0.2), rpy=(0.2, 0.4, -0.3))
    model = pin.buildModelFromXML(urdf(mounted))
    assert has_dimensions(model)
    assert has_dimensions(
        pin.buildModelFromXML(urdf(mounted), pin.JointModelFreeFlyer())
    )
    model.jointPlacements[1].translation[1] += 1e-6
    assert not has_dimensions(model)


@each("joint", range(4))
@each("end", ["lowerPositionLimit", "upperPositionLimit"])
@each("floating", [False, True])
def test_limits_are_those_of_the_record(joint: int, end: str, floating: bool) -> None:
    model = a5.load(floating_base=floating).model
    place = joint + 7 * floating
    check_limits(model, "this", ARM)
    limits = getattr(model, end).copy()
    for sign in (1.0, -1.0):
        changed = limits.copy()
        changed[place] += sign * 0.9e-9
        setattr(model, end, changed)
        check_limits(model, "this", ARM)
        changed[place] += sign * 0.2e-9
        setattr(model, end, changed)
        with pytest.raises(InputError, match=ARM.joints[joint].name):
            check_limits(model, "this", ARM)
