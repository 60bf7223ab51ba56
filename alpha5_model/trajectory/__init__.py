"""Recorded or planned joint motion in, torques, currents, powers and mount load out.

``read_motion(file)`` or ``motion(arrays)``, then ``analyse``, then ``summary``, ``text``,
``columns`` or ``write``.
"""

from alpha5_model.trajectory.analysis import Analysis, analyse
from alpha5_model.trajectory.motions import Motion, motion, read_motion
from alpha5_model.trajectory.report import columns, summary, text, write
from alpha5_model.trajectory.smoothing import SmoothMotion, smooth
from alpha5_model.trajectory.tables import MotionWarning

__all__ = [
    "Analysis",
    "Motion",
    "MotionWarning",
    "SmoothMotion",
    "analyse",
    "columns",
    "motion",
]
__all__ += ["read_motion", "smooth", "summary", "text", "write"]
