"""Impossible quantities raise; implausible ones warn, once, where an object is made."""

from __future__ import annotations

import dataclasses
import json
import math
import subprocess
import sys
import warnings
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import alpha5_model as a5
from alpha5_model.cli import main
from alpha5_model.description.mjcf import MjcfOptions
from alpha5_model.dynamics.actuators import Actuator
from alpha5_model.errors import ImplausibleWarning, InputError
from alpha5_model.numbers.hydrodynamics import DragStrip
from alpha5_model.water.vehicle import Vehicle

P = a5.parameters()
#: Of a BlueROV2, about.
VEHICLE: dict[str, Any] = {
    "mass": 11.5,
    "com": (0.0, 0.0, 0.0),
    "inertia": np.diag([0.2, 0.25, 0.3]),
    "volume": 0.0114,
    "cob": (0.0, 0.0, 0.02),
}
NO_BODY = np.diag([1.0, 1.0, 3.0])


def vehicle(**changes: Any) -> Vehicle:
    return Vehicle(**{**VEHICLE, **changes})


def link(**changes: Any) -> Any:
    return dataclasses.replace(P.links[1], **changes)


def jaws(**changes: Any) -> Any:
    return dataclasses.replace(P.jaws, **changes)


def motor(**changes: Any) -> Any:
    return dataclasses.replace(P.actuators[0], **changes)


def joint(**changes: Any) -> Any:
    return dataclasses.replace(P.joints[0], **changes)


def payload(*args: Any, **body: Any) -> a5.Arm:
    return a5.load().with_payload(*args, **body)


def heavier_than_nothing(mass: float) -> a5.Arm:
    model = a5.load().model
    model.inertias[2].mass = mass
    return a5.Arm(model, ())


def flattened() -> a5.Arm:
    import pinocchio as pin

    model = a5.load().model
    model.inertias[2] = pin.Inertia(0.4, np.zeros(3), NO_BODY)
    return a5.Arm(model, ())


#: What is made -> what the warning names, and what to write instead.
IMPLAUSIBLE: dict[str, tuple[Callable[[], Any], str, str]] = {
    "density in g/cm^3": (lambda: a5.load(1.025), "fluid_density", "write 1025"),
    "MuJoCo's density": (
        lambda: MjcfOptions(fluid_density=1.025),
        "fluid_density",
        "write 1025",
    ),
    "gravity upwards": (
        lambda: a5.load(gravity=(0, 0, 9.81)),
        "gravity",
        "write (0, 0, -9.81)",
    ),
    "gravity in g": (
        lambda: a5.load(gravity=(0, 0, -1)),
        "gravity",
        "write (0, 0, -9.81)",
    ),
    "payload in g": (lambda: payload(500), "mass", "write 0.5"),
    "payload's COM in mm": (
        lambda: payload(0.5, (0, 0, 20)),
        "com",
        "write (0, 0, 0.02)",
    ),
    "payload's litres": (lambda: payload(0.5, volume=0.5), "volume", "write 0.0005"),
    "payload's kg mm^2": (
        lambda: payload(0.7, inertia=5 * np.eye(3)),
        "inertia",
        "kg mm^2, multiply it by 1e-06",
    ),
    "vehicle's litres": (lambda: vehicle(volume=11.4), "volume", "write 0.0114"),
    "vehicle in g": (lambda: vehicle(mass=11500), "volume", "write 11.5"),
    "a vehicle of no known unit": (
        lambda: vehicle(mass=0.7, volume=11.4, inertia=np.diag([0.01, 0.01, 0.01])),
        "volume",
        "0.0614 kg/m^3",
    ),
    "link in g": (lambda: link(mass=161), "links.link_1.mass", "write 0.161"),
    "speed in degrees": (lambda: joint(velocity=30), "axis_e.velocity", "write 0.523"),
    "acceleration in degrees": (
        lambda: joint(acceleration=90.0),
        "axis_e.acceleration",
        "write 1.57",
    ),
    "rod's limits in mm": (
        lambda: dataclasses.replace(P.joints[4], upper=13.3),
        "axis_a.upper",
        "write 0.0133",
    ),
    "a_1 in mm": (lambda: dataclasses.replace(P.dh[1], a=150.7), "a", "write 0.1507"),
    "screw lead in mm": (
        lambda: a5.actuators.actuator("axis_a", screw_lead=1),
        "screw_lead",
        "write 0.001",
    ),
    "strip in mm": (
        lambda: DragStrip((0, 0, 0), (0, 0, 0.1), diameter=40, across=1.0),
        "diameter",
        "write 0.04",
    ),
}


@pytest.mark.parametrize("case", IMPLAUSIBLE)
def test_an_implausible_quantity_warns_once_here_with_the_unit(case: str) -> None:
    make, name, remedy = IMPLAUSIBLE[case]
    with pytest.warns(ImplausibleWarning) as found:
        make()
    (warning,) = found
    assert warning.filename == __file__
    assert str(warning.message).startswith(f"{name}: ")
    assert remedy in str(warning.message)
    assert "\n" not in str(warning.message)


#: What is made -> what the error names.
IMPOSSIBLE: dict[str, tuple[Callable[[], Any], str]] = {
    "link": (lambda: link(mass=-0.4), "links.link_1.mass"),
    "link's tensor": (lambda: link(inertia=NO_BODY), "links.link_1.inertia"),
    "link's bounds": (lambda: link(bounds=-P.links[1].bounds), "links.link_1.bounds"),
    "link's COM": (lambda: link(com=(0, 0, math.nan)), "links.link_1.com"),
    "link's COM in mm": (lambda: link(com=(7.7, 0.1, 25)), "links.link_1.com"),
    "no mass, but inertia": (lambda: link(mass=0.0), "links.link_1.inertia"),
    "rod's length": (lambda: jaws(rod_length=-0.05), "rod_length"),
    "fluid": (lambda: a5.load(-0.5), "fluid_density"),
    "payload": (lambda: payload(-0.5), "mass"),
    "vehicle": (lambda: vehicle(mass=-11.5), "mass"),
    "limits": (lambda: joint(upper=-1.0), "axis_e.range"),
    "efficiency in %": (lambda: motor(efficiency=86), "efficiency"),
    "resistance": (lambda: motor(resistance=-0.5), "resistance"),
    "rotor": (
        lambda: Actuator("axis_e", P.actuators[0], rotor_inertia=-1e-6),
        "rotor_inertia",
    ),
    "five links": (lambda: dataclasses.replace(P, links=P.links[:4]), "links"),
    "no links": (lambda: dataclasses.replace(P, links=(1, 2, 3, 4, 5)), "links"),
    "strip's diameter": (
        lambda: DragStrip((0, 0, 0), (0, 0, 0.1), diameter=-0.04, across=1.0),
        "diameter",
    ),
    "model's mass": (lambda: heavier_than_nothing(-0.4), "mass on axis_d"),
    "model's tensor": (flattened, "inertia on axis_d"),
}


def test_an_impossible_quantity_raises() -> None:
    for make, name in IMPOSSIBLE.values():
        with pytest.raises(InputError) as caught:
            make()
        assert caught.value.name == name


#: Made without a word.
PLAUSIBLE: dict[str, Callable[[], Any]] = {
    "air": lambda: a5.load(1.2),
    "nothing": lambda: a5.load(0.0),
    "brine": lambda: a5.load(1240.0),
    "the Moon": lambda: a5.load(gravity=(0, 0, -1.62)),
    "weightless": lambda: a5.load(gravity=(0, 0, 0)),
    "upside down": lambda: a5.load(
        gravity=a5.gravity_in_base(np.diag([1.0, -1.0, -1.0]))
    ),
    "NED": lambda: a5.load(gravity=a5.gravity_in_base(np.eye(3), (0.0, 0.0, 9.81))),
    "on a wall": lambda: a5.load(gravity=(9.81, 0, 0)),
    "hanging askew": lambda: a5.load(gravity=(3.0, 0.0, 9.3)),
    "hanging askew sideways": lambda: a5.load(gravity=(0.0, 3.0, 9.3)),
    "ballast": lambda: payload(20.0, (0, 0, 0.1), volume=20 / 7850),
    "a float": lambda: payload(0.0, volume=1e-3),
    "foam": lambda: payload(0.02, volume=1e-3),
    "a pole": lambda: payload(1.0, (0, 0, 1), np.diag([0.34, 0.34, 1e-4])),
    "a vehicle": vehicle,
    "no vehicle": lambda: vehicle(mass=0.0, inertia=np.zeros((3, 3)), volume=0.0),
    "work class": lambda: vehicle(mass=4e3, volume=4.0, inertia=4e3 * np.eye(3)),
    "a massless link": lambda: link(mass=0.0, inertia=np.zeros((3, 3))),
    "a link of its own": lambda: link(mass=0.3, com=[0.01, 0.0, 0.02]),
}


def test_what_may_be_meant_passes() -> None:
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        for make in PLAUSIBLE.values():
            make()


def test_replaced_records_hold_arrays_of_their_own_that_nobody_can_write() -> None:
    given = np.array([0.01, 0.0, 0.02])
    made = link(com=given)
    given[0] = 7.0
    assert made.com.tolist() == [0.01, 0.0, 0.02]
    assert not made.com.flags.writeable


def test_an_arm_warns_when_it_is_made_and_not_in_a_loop() -> None:
    with pytest.warns(ImplausibleWarning):
        arm = a5.load(1.025)
    with pytest.warns(ImplausibleWarning, match="500 kg"):
        loaded = arm.with_payload(500)
    with pytest.warns(ImplausibleWarning, match="water_velocity"):
        wet = a5.load().with_hydrodynamics((0, 50, 0))
    q, v = np.full(4, 1.7), np.full(4, 170.0)
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        for made in (arm, loaded):
            made.inverse_dynamics(q, v, v)
            made.inverse_dynamics_batch(q, v, v)
            made.hydrostatic_torque(q)
            made.base_wrench(q, v, v)
            made.with_payload(0.5)
            made.with_hydrodynamics()
        wet.inverse_dynamics(q, v, v, water_velocity=(0, 100, 0))
        wet.with_payload(0.1)


def test_a_filter_of_the_category_silences_it() -> None:
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        warnings.simplefilter("ignore", a5.errors.ImplausibleWarning)
        a5.load(1.025).with_payload(500)
        with pytest.raises(InputError):
            payload(-500)
    assert issubclass(ImplausibleWarning, UserWarning)


COMMANDS = {
    "torque --q 3 1 1 0 --fluid 1.025": ["fluid_density: 1.025 kg/m^3", "write 1025"],
    "torque --q 3 1 1 0 --payload 500": ["mass: 500 kg", "if it is in g, write 0.5"],
    "torque --q 3 1 1 0 --gravity 0 0 9.81": ["points up", "--mount"],
    "torque --q 3 1 1 0 --json --fluid 1.025": [
        "fluid_density: 1.025 kg/m^3",
        "write 1025",
    ],
}


@pytest.mark.parametrize("command", COMMANDS)
def test_commands_print_one_line(
    command: str, capsys: pytest.CaptureFixture[str]
) -> None:
    assert main(command.split()) == 0
    out, err = capsys.readouterr()
    (line,) = err.splitlines()
    assert line.startswith("alpha5: warning: ")
    assert all(word in line for word in COMMANDS[command])
    assert ".py" not in line
    if "--json" in command:
        assert json.loads(out)["fluid_density"] == 1.025


QUIET = (
    "torque --q 3 1 1 0 --gravity 0 0 9.81 --mount 180 0 0 deg",
    "torque --q 3 1 1 0 --mount 180 0 0 deg --payload 0.5 0 0 0.02 --fluid fresh",
)


@pytest.mark.parametrize("command", QUIET)
def test_commands_are_quiet_otherwise(
    command: str, capsys: pytest.CaptureFixture[str]
) -> None:
    assert main(command.split()) == 0
    assert capsys.readouterr().err == ""


@pytest.mark.slow
def test_a_study_warns_when_it_is_read_and_not_of_each_case(tmp_path: Path) -> None:
    axes = "\n".join(f"axis_{x}_pos = 1.0" for x in "edcb")
    study = f"""
        [axes]
        {axes}
        payload_mass = [0.0, 0.2, 500.0]
        fluid_density = {{from = 0.0, to = 1000.0, count = 3}}
        [outputs]
        most = {{quantity = "torque", as = "peak"}}
    """
    file = tmp_path / "study.toml"
    file.write_text(study.replace("\n        ", "\n"))
    with pytest.warns(
        ImplausibleWarning, match=r"axes.payload_mass: 500 kg .* write 0.5$"
    ) as said:
        a5.sweep(file, tmp_path / "out")
    assert len(said) == 1


EVERYTHING = """
import warnings
import alpha5_model as a5

a5.audit()
a5.uncertainty.sample(3).parameters(0)
for gripper in ("locked", "jaws"):
    for base in (False, True):
        arm = a5.load(gripper=gripper, floating_base=base)
        arm.with_hydrodynamics()
[a5.actuators.actuator(f"axis_{x}").extremes() for x in "edcba"]
a5.parameters(("link3_cob",))
a5.robot_wrapper("jaws")
"""


@pytest.mark.slow
def test_the_package_itself_is_quiet() -> None:
    options = ("-W", "error", "-W", "ignore::DeprecationWarning")
    done = subprocess.run(
        [sys.executable, *options, "-c", EVERYTHING],
        check=False,
        capture_output=True,
        text=True,
        timeout=120,
    )
    assert (done.returncode, done.stderr) == (0, "")
