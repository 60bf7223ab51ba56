"""The Reach Alpha 5 arm: URDF, dynamics under water and closed-form inverse kinematics.

Generated from the manufacturer's printed tables. ``import alpha5_model`` loads no other package;
Pinocchio, xacro, meshcat and matplotlib are imported when something that needs them is called.
"""

from __future__ import annotations

from importlib import import_module
from typing import TYPE_CHECKING, Any

from alpha5_model.errors import Alpha5Error, UnreachableError

__version__ = "0.1.0"

if TYPE_CHECKING:
    from alpha5_model import trajectory
    from alpha5_model._support.paths import PACKAGE_PATH, REPOSITORY_PATH, URDF_PATH
    from alpha5_model.codegen.kernels.choice import backend
    from alpha5_model.description.srdf import named_pose
    from alpha5_model.dynamics import actuators
    from alpha5_model.dynamics.arm import Arm
    from alpha5_model.dynamics.collision import without_self_collision
    from alpha5_model.dynamics.load import load, robot_wrapper
    from alpha5_model.kinematics import workspace
    from alpha5_model.kinematics.ik import (
        BRANCHES,
        inverse_kinematics,
        published_inverse_kinematics,
    )
    from alpha5_model.kinematics.path import inverse_kinematics_path
    from alpha5_model.kinematics.pose import inverse_kinematics_pose
    from alpha5_model.kinematics.reach import (
        distance_to_reach,
        nearest_reachable,
        reachable,
    )
    from alpha5_model.numbers.fluids import AIR, FRESH_WATER, SEA_WATER, gravity_in_base
    from alpha5_model.numbers.hydrodynamics import DragStrip
    from alpha5_model.numbers.parameters import parameters
    from alpha5_model.numbers.printed import published
    from alpha5_model.proofs.audit import audit
    from alpha5_model.proofs.comparison import compare
    from alpha5_model.studies import uncertainty
    from alpha5_model.studies.sweep import sweep
    from alpha5_model.studies.uncertainty import identify
    from alpha5_model.theory import dh, planar
    from alpha5_model.viewer import view
    from alpha5_model.water.vehicle import Vehicle

# For checkers of types, which need the names written out; a name that is not imported above they report.
__all__ = [
    "AIR",
    "BRANCHES",
    "FRESH_WATER",
    "PACKAGE_PATH",
    "REPOSITORY_PATH",
    "SEA_WATER",
]
__all__ += [
    "URDF_PATH",
    "Alpha5Error",
    "Arm",
    "DragStrip",
    "UnreachableError",
    "Vehicle",
]
__all__ += [
    "__version__",
    "actuators",
    "audit",
    "backend",
    "compare",
    "dh",
    "distance_to_reach",
]
__all__ += [
    "gravity_in_base",
    "identify",
    "inverse_kinematics",
    "inverse_kinematics_path",
]
__all__ += [
    "inverse_kinematics_pose",
    "load",
    "named_pose",
    "nearest_reachable",
    "parameters",
]
__all__ += [
    "planar",
    "published",
    "published_inverse_kinematics",
    "reachable",
    "robot_wrapper",
]
__all__ += [
    "sweep",
    "trajectory",
    "uncertainty",
    "view",
    "without_self_collision",
    "workspace",
]
#: Module -> the public names that it defines.
_DEFINED = {
    "_support.paths": ("PACKAGE_PATH", "REPOSITORY_PATH", "URDF_PATH"),
    "codegen.kernels.choice": ("backend",),
    "description.srdf": ("named_pose",),
    "dynamics.arm": ("Arm",),
    "dynamics.collision": ("without_self_collision",),
    "dynamics.load": ("load", "robot_wrapper"),
    "kinematics.ik": ("BRANCHES", "inverse_kinematics", "published_inverse_kinematics"),
    "kinematics.path": ("inverse_kinematics_path",),
    "kinematics.pose": ("inverse_kinematics_pose",),
    "kinematics.reach": ("distance_to_reach", "nearest_reachable", "reachable"),
    "numbers.fluids": ("AIR", "FRESH_WATER", "SEA_WATER", "gravity_in_base"),
    "numbers.hydrodynamics": ("DragStrip",),
    "numbers.parameters": ("parameters",),
    "numbers.printed": ("published",),
    "proofs.audit": ("audit",),
    "proofs.comparison": ("compare",),
    "studies.sweep": ("sweep",),
    "studies.uncertainty": ("identify",),
    "viewer": ("view",),
    "water.vehicle": ("Vehicle",),
}
#: Public modules.
_MODULES = (
    "_support.paths",
    "dynamics.actuators",
    "kinematics.workspace",
    "numbers.corrections",
    "numbers.fluids",
    "numbers.inertia",
    "studies.uncertainty",
    "theory.dh",
    "theory.planar",
    "trajectory",
)
_PUBLIC = {name: (module, name) for module, names in _DEFINED.items() for name in names}
_PUBLIC |= {module.rpartition(".")[2]: (module, "") for module in _MODULES}


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
