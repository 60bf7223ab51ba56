"""Recorded or planned joint motion in, torques, currents, powers and mount load out.

``read_motion(file)`` or ``motion(arrays)``, then ``analyse``, then ``summary``,
``text``, ``columns`` or ``write``.
"""

from alpha5_model.trajectory.analysis import Analysis, analyse
from alpha5_model.trajectory.checks import motion
from alpha5_model.trajectory.key_figures import summary
from alpha5_model.trajectory.motions import Motion, MotionWarning
from alpha5_model.trajectory.recordings import read_motion
from alpha5_model.trajectory.report import text
from alpha5_model.trajectory.smoothing import SmoothMotion, smooth
from alpha5_model.trajectory.time_series import columns, write

__all__ = [
    "Analysis",
    "Motion",
    "MotionWarning",
    "SmoothMotion",
    "analyse",
    "columns",
    "motion",
    "read_motion",
    "smooth",
    "summary",
    "text",
    "write",
]
