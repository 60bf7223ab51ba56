# The public names, each in one line: type checkers read them here, and __init__.py
# makes its table of them. A line is ``from MODULE import NAME as PUBLIC``.
# ruff: isort: skip_file

__version__: str
# Type checkers export a name that an import changes only if it stands here.
__all__ = ["calibrate"]

# What was printed, and the same in SI units.
from alpha5_model.numbers.printed import published as published
from alpha5_model.numbers.parameters import parameters as parameters
from alpha5_model.numbers.arm_file import arm_file as arm_file
from alpha5_model.numbers.arm_writing import arm_file_text as arm_file_text
from alpha5_model.numbers.fluids import SEA_WATER as SEA_WATER
from alpha5_model.numbers.fluids import FRESH_WATER as FRESH_WATER
from alpha5_model.numbers.fluids import AIR as AIR
from alpha5_model.numbers.fluids import gravity_in_base as gravity_in_base
from alpha5_model.numbers.hydrodynamics import DragStrip as DragStrip
from alpha5_model.numbers import corrections as corrections
from alpha5_model.numbers import fluids as fluids
from alpha5_model.numbers import inertia as inertia

# The files.
from alpha5_model._support.paths import URDF_PATH as URDF_PATH
from alpha5_model._support.paths import PACKAGE_PATH as PACKAGE_PATH
from alpha5_model._support.paths import REPOSITORY_PATH as REPOSITORY_PATH
from alpha5_model._support import paths as paths
from alpha5_model.description.srdf import named_pose as named_pose

# Where the arm can be, and how it moves there.
from alpha5_model.kinematics.ik import BRANCHES as BRANCHES
from alpha5_model.kinematics.ik import inverse_kinematics as inverse_kinematics
from alpha5_model.kinematics.pose import (
    inverse_kinematics_pose as inverse_kinematics_pose,
)
from alpha5_model.kinematics.path import (
    inverse_kinematics_path as inverse_kinematics_path,
)
from alpha5_model.kinematics.reach import reachable as reachable
from alpha5_model.kinematics.reach import distance_to_reach as distance_to_reach
from alpha5_model.kinematics.reach import nearest_reachable as nearest_reachable
from alpha5_model.kinematics.bus_devices import q_from_devices as q_from_devices
from alpha5_model.kinematics.bus_devices import devices_from_q as devices_from_q
from alpha5_model.numbers.jaws import tool_at_tip as tool_at_tip
from alpha5_model import workspace as workspace
from alpha5_model.theory import dh as dh
from alpha5_model.theory import planar as planar

# Dynamics, dry, in still and in moving water.
from alpha5_model.dynamics.load import load as load
from alpha5_model.dynamics.load import robot_wrapper as robot_wrapper
from alpha5_model.dynamics.arm import Arm as Arm
from alpha5_model.dynamics import actuators as actuators
from alpha5_model.dynamics.jaw_tool import jaws as jaws
from alpha5_model.collision.self_collision import (
    without_self_collision as without_self_collision,
)
from alpha5_model.kernels.choice import backend as backend
from alpha5_model.water.vehicle import Vehicle as Vehicle

# Motions.
from alpha5_model import trajectory as trajectory
from alpha5_model.planning.obstacles import Obstacle as Obstacle
from alpha5_model.planning.planner import plan as plan
from alpha5_model.planning.parking import placements as placements

# Studies and proofs.
from alpha5_model.studies import calibration as calibrate
from alpha5_model.studies import control as control
from alpha5_model.studies import uncertainty as uncertainty
from alpha5_model.studies.sweep import sweep as sweep
from alpha5_model.proofs.audit import audit as audit
from alpha5_model.proofs.audit.printed_inverse_kinematics import (
    published_inverse_kinematics as published_inverse_kinematics,
)
from alpha5_model.proofs.comparison import compare as compare

# For the eye.
from alpha5_model.viewer import view as view

# Errors.
from alpha5_model import errors as errors
from alpha5_model.errors import Alpha5Error as Alpha5Error
from alpha5_model.errors import SelfCollisionError as SelfCollisionError
from alpha5_model.errors import UnreachableError as UnreachableError
