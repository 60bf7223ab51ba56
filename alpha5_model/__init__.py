"""The Reach Alpha 5 arm: URDF, dynamics under water and closed-form inverse kinematics.

Generated from the manufacturer's printed tables. ``import alpha5_model`` loads NumPy only; Pinocchio,
xacro, meshcat and matplotlib are imported when something that needs them is called.
"""

from __future__ import annotations

from importlib import import_module
from typing import TYPE_CHECKING, Any

from alpha5_model.errors import Alpha5Error, UnreachableError

# Three functions that share their module's name: bound now, so that a later import of the module
# cannot put itself in the function's place.
from alpha5_model.parameters import parameters
from alpha5_model.published import published
from alpha5_model.view import view

__version__ = "0.1.0"

if TYPE_CHECKING:
    from alpha5_model import actuators as actuators
    from alpha5_model import trajectory as trajectory
    from alpha5_model.comparison.report import compare as compare
    from alpha5_model.consistency.document import audit as audit
    from alpha5_model.description.poses import named_pose as named_pose
    from alpha5_model.dynamics.arm import Arm as Arm
    from alpha5_model.dynamics.loading import load as load
    from alpha5_model.dynamics.loading import robot_wrapper as robot_wrapper
    from alpha5_model.dynamics.water import AIR as AIR
    from alpha5_model.dynamics.water import FRESH_WATER as FRESH_WATER
    from alpha5_model.dynamics.water import SEA_WATER as SEA_WATER
    from alpha5_model.dynamics.water import gravity_in_base as gravity_in_base
    from alpha5_model.kinematics import dh as dh
    from alpha5_model.kinematics import planar as planar
    from alpha5_model.kinematics import workspace as workspace
    from alpha5_model.kinematics.ik import BRANCHES as BRANCHES
    from alpha5_model.kinematics.ik import inverse_kinematics as inverse_kinematics
    from alpha5_model.kinematics.ik_path import inverse_kinematics_path as inverse_kinematics_path
    from alpha5_model.kinematics.ik_pose import inverse_kinematics_pose as inverse_kinematics_pose
    from alpha5_model.kinematics.ik_published import (
        published_inverse_kinematics as published_inverse_kinematics,
    )
    from alpha5_model.kinematics.reach import distance_to_reach as distance_to_reach
    from alpha5_model.kinematics.reach import nearest_reachable as nearest_reachable
    from alpha5_model.kinematics.reach import reachable as reachable
    from alpha5_model.paths import PACKAGE_PATH as PACKAGE_PATH
    from alpha5_model.paths import REPOSITORY_PATH as REPOSITORY_PATH
    from alpha5_model.paths import URDF_PATH as URDF_PATH

#: Public name -> module that defines it; None where the name is the module itself.
_PUBLIC: dict[str, tuple[str, str | None]] = {
    "BRANCHES": ("alpha5_model.kinematics.ik", "BRANCHES"),
    "AIR": ("alpha5_model.dynamics.water", "AIR"),
    "Arm": ("alpha5_model.dynamics.arm", "Arm"),
    "FRESH_WATER": ("alpha5_model.dynamics.water", "FRESH_WATER"),
    "compare": ("alpha5_model.comparison.report", "compare"),
    "PACKAGE_PATH": ("alpha5_model.paths", "PACKAGE_PATH"),
    "REPOSITORY_PATH": ("alpha5_model.paths", "REPOSITORY_PATH"),
    "SEA_WATER": ("alpha5_model.dynamics.water", "SEA_WATER"),
    "URDF_PATH": ("alpha5_model.paths", "URDF_PATH"),
    "audit": ("alpha5_model.consistency.document", "audit"),
    "dh": ("alpha5_model.kinematics.dh", None),
    "distance_to_reach": ("alpha5_model.kinematics.reach", "distance_to_reach"),
    "inverse_kinematics": ("alpha5_model.kinematics.ik", "inverse_kinematics"),
    "inverse_kinematics_path": ("alpha5_model.kinematics.ik_path", "inverse_kinematics_path"),
    "inverse_kinematics_pose": ("alpha5_model.kinematics.ik_pose", "inverse_kinematics_pose"),
    "nearest_reachable": ("alpha5_model.kinematics.reach", "nearest_reachable"),
    "published_inverse_kinematics": (
        "alpha5_model.kinematics.ik_published",
        "published_inverse_kinematics",
    ),
    "reachable": ("alpha5_model.kinematics.reach", "reachable"),
    "workspace": ("alpha5_model.kinematics.workspace", None),
    "gravity_in_base": ("alpha5_model.dynamics.water", "gravity_in_base"),
    "named_pose": ("alpha5_model.description.poses", "named_pose"),
    "load": ("alpha5_model.dynamics.loading", "load"),
    "robot_wrapper": ("alpha5_model.dynamics.loading", "robot_wrapper"),
    "planar": ("alpha5_model.kinematics.planar", None),
    "actuators": ("alpha5_model.actuators", None),
    "trajectory": ("alpha5_model.trajectory", None),
}

__all__ = [
    "Alpha5Error",
    "UnreachableError",
    "__version__",
    "parameters",
    "published",
    "view",
    *sorted(_PUBLIC),
]


def __getattr__(name: str) -> Any:
    if name not in _PUBLIC:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    module_name, attribute = _PUBLIC[name]
    module = import_module(module_name)
    value = module if attribute is None else getattr(module, attribute)
    globals()[name] = value
    return value


def __dir__() -> list[str]:
    return sorted({*globals(), *_PUBLIC})
