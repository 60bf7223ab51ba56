"""Recorded or planned joint motion in, torques, currents, powers and mount load out.

``read_motion(file)`` or ``motion(arrays)``, then ``analyse``, then ``summary``, ``text``,
``columns`` or ``write``.
"""

from alpha5_model.trajectory.analysis import Analysis, analyse
from alpha5_model.trajectory.motion import Motion, MotionWarning, motion
from alpha5_model.trajectory.reading import read_motion
from alpha5_model.trajectory.report import columns, summary, write
from alpha5_model.trajectory.report_text import text
from alpha5_model.trajectory.smoothing import SmoothMotion, smooth

__all__ = ["Analysis", "Motion", "MotionWarning", "SmoothMotion", "analyse", "columns", "motion"]
__all__ += ["read_motion", "smooth", "summary", "text", "write"]
