"""Motions that the arm can make: free of collision, and within its limits."""

from alpha5_model.planning.goals import Target
from alpha5_model.planning.obstacles import Mesh, Obstacle
from alpha5_model.planning.planned_motion import PlannedMotion, Stop
from alpha5_model.planning.planner import plan
from alpha5_model.planning.replay import Peak
from alpha5_model.planning.waypoints import read_waypoints

__all__ = [
    "Mesh",
    "Obstacle",
    "Peak",
    "PlannedMotion",
    "Stop",
    "Target",
    "plan",
    "read_waypoints",
]
