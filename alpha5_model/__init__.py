"""The Reach Alpha 5 arm: URDF, dynamics under water and closed-form inverse kinematics.

Generated from the manufacturer's printed tables. ``import alpha5_model`` loads NumPy only;
Pinocchio, xacro, meshcat and matplotlib are imported when something that needs them is called.
"""

from __future__ import annotations

import sys
from importlib import import_module
from typing import TYPE_CHECKING, Any

from alpha5_model.errors import Alpha5Error, UnreachableError

# Four functions that share their module's name: bound now, so that a later import of the module
# cannot put itself in the function's place.
from alpha5_model.parameters import parameters
from alpha5_model.published import published
from alpha5_model.sweep import sweep
from alpha5_model.view import view

__version__ = "0.1.0"

# `import alpha5_model.parameters as P` gives the function, too, which stands in the module's place:
# it has the module's names.
for _function in (parameters, published, sweep, view):
    _names = vars(sys.modules[_function.__module__]).items()
    vars(_function).update({name: value for name, value in _names if name[:2] != "__"})

if TYPE_CHECKING:
    from alpha5_model import actuators as actuators
    from alpha5_model import dh as dh
    from alpha5_model import planar as planar
    from alpha5_model import trajectory as trajectory
    from alpha5_model import uncertainty as uncertainty
    from alpha5_model.comparison import compare as compare
    from alpha5_model.consistency import audit as audit
    from alpha5_model.description.srdf import named_pose as named_pose
    from alpha5_model.dynamics import load as load
    from alpha5_model.dynamics import robot_wrapper as robot_wrapper
    from alpha5_model.dynamics.arm import Arm as Arm
    from alpha5_model.dynamics.collision import (
        without_self_collision as without_self_collision,
    )
    from alpha5_model.dynamics.vehicle import Vehicle as Vehicle
    from alpha5_model.fluids import AIR as AIR
    from alpha5_model.fluids import FRESH_WATER as FRESH_WATER
    from alpha5_model.fluids import SEA_WATER as SEA_WATER
    from alpha5_model.fluids import gravity_in_base as gravity_in_base
    from alpha5_model.hydrodynamics import DragStrip as DragStrip
    from alpha5_model.kernels import backend as backend
    from alpha5_model.kinematics import workspace as workspace
    from alpha5_model.kinematics.ik import BRANCHES as BRANCHES
    from alpha5_model.kinematics.ik import inverse_kinematics as inverse_kinematics
    from alpha5_model.kinematics.ik import (
        published_inverse_kinematics as published_inverse_kinematics,
    )
    from alpha5_model.kinematics.ik.path import inverse_kinematics_path as inverse_kinematics_path
    from alpha5_model.kinematics.ik.pose import inverse_kinematics_pose as inverse_kinematics_pose
    from alpha5_model.kinematics.reach import distance_to_reach as distance_to_reach
    from alpha5_model.kinematics.reach import nearest_reachable as nearest_reachable
    from alpha5_model.kinematics.reach import reachable as reachable
    from alpha5_model.paths import PACKAGE_PATH as PACKAGE_PATH
    from alpha5_model.paths import REPOSITORY_PATH as REPOSITORY_PATH
    from alpha5_model.paths import URDF_PATH as URDF_PATH
    from alpha5_model.uncertainty import identify as identify

#: Module -> the public names that it defines.
_DEFINED = {
    "comparison": ("compare",),
    "consistency": ("audit",),
    "description.srdf": ("named_pose",),
    "dynamics.arm": ("Arm",),
    "dynamics": ("load", "robot_wrapper"),
    "dynamics.collision": ("without_self_collision",),
    "dynamics.vehicle": ("Vehicle",),
    "hydrodynamics": ("DragStrip",),
    "fluids": ("AIR", "FRESH_WATER", "SEA_WATER", "gravity_in_base"),
    "kernels": ("backend",),
    "kinematics.ik": ("BRANCHES", "inverse_kinematics", "published_inverse_kinematics"),
    "kinematics.ik.path": ("inverse_kinematics_path",),
    "kinematics.ik.pose": ("inverse_kinematics_pose",),
    "kinematics.reach": ("distance_to_reach", "nearest_reachable", "reachable"),
    "uncertainty": ("identify",),
    "paths": ("PACKAGE_PATH", "REPOSITORY_PATH", "URDF_PATH"),
}
#: Public modules.
_MODULES = ("actuators", "dh", "planar", "kinematics.workspace", "trajectory", "uncertainty")
_PUBLIC = {name: (module, name) for module, names in _DEFINED.items() for name in names}
_PUBLIC |= {module.rpartition(".")[2]: (module, "") for module in _MODULES}

__all__ = [
    "Alpha5Error",
    "UnreachableError",
    "__version__",
    "parameters",
    "published",
    "sweep",
    "view",
    *sorted(_PUBLIC),
]


def __getattr__(name: str) -> Any:
    if name not in _PUBLIC:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    module_name, attribute = _PUBLIC[name]
    module = import_module(f"alpha5_model.{module_name}")
    value = getattr(module, attribute) if attribute else module
    globals()[name] = value
    return value


def __dir__() -> list[str]:
    return sorted({*globals(), *_PUBLIC})
