"""Motions that the arm can make, and where its vehicle can be: free of collision."""

from alpha5_model.planning.goals import Target
from alpha5_model.planning.obstacles import Mesh, Obstacle
from alpha5_model.planning.parking import placements
from alpha5_model.planning.placement_table import Placements
from alpha5_model.planning.planned_motion import PlannedMotion, Stop
from alpha5_model.planning.planner import plan
from alpha5_model.planning.replay import Peak
from alpha5_model.planning.waypoints import read_waypoints

__all__ = [
    "Mesh",
    "Obstacle",
    "Peak",
    "Placements",
    "PlannedMotion",
    "Stop",
    "Target",
    "placements",
    "plan",
    "read_waypoints",
]
