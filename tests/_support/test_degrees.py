"""Objects that are made of angles warn of degrees once, when they are made."""

import numpy as np
import pytest

import alpha5_model as a5
from alpha5_model.description.urdf import Variant
from alpha5_model.errors import ImplausibleWarning


def test_angles_in_degrees_are_noticed_at_the_door() -> None:
    obstacle, session = a5.Obstacle.box, a5.calibrate.session
    doors = {
        "rpy": lambda angle: obstacle("rov", (0.5, 0.3, 0.2), (1, 0, 0), angle),
        "rpy of": lambda angle: Variant(parent="rov", rpy=tuple(angle)),
        "q": lambda angle: session(a5.calibrate.weight(), [[*angle, 0.0]], [[0.5]]),
    }
    for name, make in doors.items():
        make(np.radians([0.0, 90.0, 120.0]))
        with pytest.warns(ImplausibleWarning, match=f"{name.split()[0]}: .* deg"):
            make([0.0, 90.0, 120.0])
