"""The Reach Alpha 5 arm: URDF, dynamics under water and closed-form inverse kinematics.

Generated from the manufacturer's printed tables. ``import alpha5_model`` loads no other
package; Pinocchio, xacro, meshcat and matplotlib are imported when something that needs
them is called.
"""

from __future__ import annotations

from importlib import import_module
from types import ModuleType
from typing import TYPE_CHECKING, Any

from alpha5_model.errors import (
    Alpha5Error,
    MissingDependencyError,
    SelfCollisionError,
    UnreachableError,
)

__version__ = "1.0.0"

if TYPE_CHECKING:
    from alpha5_model import trajectory, workspace
    from alpha5_model._support import paths
    from alpha5_model._support.paths import PACKAGE_PATH, REPOSITORY_PATH, URDF_PATH
    from alpha5_model.collision.self_collision import without_self_collision
    from alpha5_model.description.srdf import named_pose
    from alpha5_model.dynamics import actuators
    from alpha5_model.dynamics.arm import Arm
    from alpha5_model.dynamics.jaw_tool import jaws
    from alpha5_model.dynamics.load import load, robot_wrapper
    from alpha5_model.kernels.choice import backend
    from alpha5_model.kinematics.bus_devices import devices_from_q, q_from_devices
    from alpha5_model.kinematics.ik import BRANCHES, inverse_kinematics
    from alpha5_model.kinematics.path import inverse_kinematics_path
    from alpha5_model.kinematics.pose import inverse_kinematics_pose
    from alpha5_model.kinematics.reach import (
        distance_to_reach,
        nearest_reachable,
        reachable,
    )
    from alpha5_model.numbers import corrections, fluids, inertia
    from alpha5_model.numbers.arm_file import arm_file
    from alpha5_model.numbers.arm_writing import arm_file_text
    from alpha5_model.numbers.fluids import AIR, FRESH_WATER, SEA_WATER, gravity_in_base
    from alpha5_model.numbers.hydrodynamics import DragStrip
    from alpha5_model.numbers.jaws import tool_at_tip
    from alpha5_model.numbers.parameters import parameters
    from alpha5_model.numbers.printed import published
    from alpha5_model.planning.obstacles import Obstacle
    from alpha5_model.planning.parking import placements
    from alpha5_model.planning.planner import plan
    from alpha5_model.proofs.audit import audit
    from alpha5_model.proofs.audit.printed_inverse_kinematics import (
        published_inverse_kinematics,
    )
    from alpha5_model.proofs.comparison import compare
    from alpha5_model.studies import calibration as calibrate
    from alpha5_model.studies import control, uncertainty
    from alpha5_model.studies.sweep import sweep
    from alpha5_model.theory import dh, planar
    from alpha5_model.viewer import view
    from alpha5_model.water.vehicle import Vehicle

#: All public names, written out for type checkers.
__all__ = [
    "AIR",
    "BRANCHES",
    "FRESH_WATER",
    "PACKAGE_PATH",
    "REPOSITORY_PATH",
    "SEA_WATER",
    "URDF_PATH",
    "Alpha5Error",
    "Arm",
    "DragStrip",
    "Obstacle",
    "SelfCollisionError",
    "UnreachableError",
    "Vehicle",
    "__version__",
    "actuators",
    "arm_file",
    "arm_file_text",
    "audit",
    "backend",
    "calibrate",
    "compare",
    "control",
    "corrections",
    "devices_from_q",
    "dh",
    "distance_to_reach",
    "fluids",
    "gravity_in_base",
    "inertia",
    "inverse_kinematics",
    "inverse_kinematics_path",
    "inverse_kinematics_pose",
    "jaws",
    "load",
    "named_pose",
    "nearest_reachable",
    "parameters",
    "paths",
    "placements",
    "plan",
    "planar",
    "published",
    "published_inverse_kinematics",
    "q_from_devices",
    "reachable",
    "robot_wrapper",
    "sweep",
    "tool_at_tip",
    "trajectory",
    "uncertainty",
    "view",
    "without_self_collision",
    "workspace",
]

#: Public name -> the module that defines it.
_NAMES = {
    # What was printed, and the same in SI units.
    "published": "numbers.printed",
    "parameters": "numbers.parameters",
    "arm_file": "numbers.arm_file",
    "arm_file_text": "numbers.arm_writing",
    "SEA_WATER": "numbers.fluids",
    "FRESH_WATER": "numbers.fluids",
    "AIR": "numbers.fluids",
    "gravity_in_base": "numbers.fluids",
    "DragStrip": "numbers.hydrodynamics",
    # The files.
    "URDF_PATH": "_support.paths",
    "PACKAGE_PATH": "_support.paths",
    "REPOSITORY_PATH": "_support.paths",
    "named_pose": "description.srdf",
    # Where the arm can be, and how it moves there.
    "BRANCHES": "kinematics.ik",
    "tool_at_tip": "numbers.jaws",
    "inverse_kinematics": "kinematics.ik",
    "published_inverse_kinematics": "proofs.audit.printed_inverse_kinematics",
    "inverse_kinematics_pose": "kinematics.pose",
    "inverse_kinematics_path": "kinematics.path",
    "reachable": "kinematics.reach",
    "distance_to_reach": "kinematics.reach",
    "nearest_reachable": "kinematics.reach",
    "q_from_devices": "kinematics.bus_devices",
    "devices_from_q": "kinematics.bus_devices",
    # Dynamics, dry, in still and in moving water.
    "load": "dynamics.load",
    "robot_wrapper": "dynamics.load",
    "Arm": "dynamics.arm",
    "jaws": "dynamics.jaw_tool",
    "without_self_collision": "collision.self_collision",
    "backend": "kernels.choice",
    "Vehicle": "water.vehicle",
    # Motions.
    "Obstacle": "planning.obstacles",
    "plan": "planning.planner",
    "placements": "planning.parking",
    # Studies and proofs.
    "sweep": "studies.sweep",
    "audit": "proofs.audit",
    "compare": "proofs.comparison",
    # For the eye.
    "view": "viewer",
}
#: Public module -> where it is.
_MODULES = {
    "paths": "_support.paths",
    "corrections": "numbers.corrections",
    "fluids": "numbers.fluids",
    "inertia": "numbers.inertia",
    "workspace": "workspace",
    "actuators": "dynamics.actuators",
    "trajectory": "trajectory",
    "uncertainty": "studies.uncertainty",
    "calibrate": "studies.calibration",
    "control": "studies.control",
    "dh": "theory.dh",
    "planar": "theory.planar",
}


def __getattr__(name: str) -> Any:
    """Import a public name when it is first used."""
    if name in _MODULES:
        value: Any = _imported(_MODULES[name], needed_for=name)
    elif name in _NAMES:
        value = getattr(_imported(_NAMES[name], needed_for=name), name)
    else:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    globals()[name] = value
    return value


def _imported(module: str, needed_for: str) -> ModuleType:
    """A module of the package.

    Raises:
        MissingDependencyError: It imports a package that is not installed.
    """
    try:
        return import_module(f"alpha5_model.{module}")
    except MissingDependencyError:
        raise
    except ModuleNotFoundError as error:
        remedy = "python -m pip install alpha5-model, without --no-deps"
        raise MissingDependencyError(
            str(error.name), f"alpha5_model.{needed_for}", remedy
        ) from None


def __dir__() -> list[str]:
    return __all__
