"""Gains of a first controller: independent PD with gravity and buoyancy compensation.

`gains` computes them for a wanted bandwidth from inertia, sample rate and delay.
`step` simulates them with current limits, friction, delay and quantisation. `margins`
has the classical margins of any PD loop, such as yours.
"""

from alpha5_model.studies.control.files import mujoco_files, ros2_control
from alpha5_model.studies.control.loop import Margins, margins
from alpha5_model.studies.control.pd_gains import Gains, gains
from alpha5_model.studies.control.simulation import Step, step

__all__ = [
    "Gains",
    "Margins",
    "Step",
    "gains",
    "margins",
    "mujoco_files",
    "ros2_control",
    "step",
]
