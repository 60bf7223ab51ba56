"""OMPL plans among obstacles; each of its edges is proved free, not sampled.

    python examples/plan_with_ompl.py

`a5.plan` is no general planner. Here it finds no way, and OMPL [Sucan2012]_ does: its
RRT-Connect asks whether whole edges are free.

.. [Sucan2012] Sucan, Moll, Kavraki: The Open Motion Planning Library, IEEE Robotics and
   Automation Magazine 19 (4), 2012.
"""

from __future__ import annotations

import numpy as np
from ompl import base, geometric, util

import alpha5_model as a5
from alpha5_model.planning.surroundings import Surroundings

#: Two posts and a bar between them, fixed in base_link [m].
OBSTACLES = [
    a5.Obstacle.cylinder("left post", radius=0.02, length=1.0, xyz=(0.18, 0.16, 0.0)),
    a5.Obstacle.cylinder("right post", radius=0.02, length=1.0, xyz=(0.18, -0.16, 0.0)),
    a5.Obstacle.box("bar", (0.02, 0.32, 0.02), xyz=(0.18, 0.0, 0.12)),
]
MARGIN = 0.005  # [m]
ENDS = [0.06, -0.03, 0.32], [0.25, -0.14, 0.04]  # of the tcp, in base_link [m]


class ProvedEdges(base.MotionValidator):
    """An edge is valid if it is proved free from end to end."""

    def __init__(self, space: base.SpaceInformation, around: Surroundings) -> None:
        super().__init__(space)
        self._around = around

    def checkMotion(self, start: base.State, end: base.State) -> bool:
        """Called by OMPL."""
        return self._around.obstruction(joints(start), joints(end)) is None


def joints(state: base.State) -> np.ndarray:
    """The joint position of a state of OMPL, (4,) [rad]."""
    return np.array([state[k] for k in range(4)])


def way(start: np.ndarray, goal: np.ndarray, seconds: float = 5.0) -> np.ndarray:
    """Ends of free straight joint lines from start to goal, (K, 4) [rad]."""
    arm = a5.load()
    around = Surroundings(arm.parameters, OBSTACLES, MARGIN)
    bounds = base.RealVectorBounds(4)
    for k in range(4):
        bounds.setLow(k, arm.limits.lower[k])
        bounds.setHigh(k, arm.limits.upper[k])
    space = base.RealVectorStateSpace(4)
    space.setBounds(bounds)

    setup = geometric.SimpleSetup(space)
    information = setup.getSpaceInformation()
    setup.setStateValidityChecker(lambda q: not around.touches(joints(q)[None])[0])
    information.setMotionValidator(ProvedEdges(information, around))
    setup.setPlanner(geometric.RRTConnect(information))
    first, last = space.allocState(), space.allocState()
    for k in range(4):
        first[k], last[k] = start[k], goal[k]
    setup.setStartAndGoalStates(first, last)
    assert setup.solve(seconds), "OMPL found no way"
    setup.simplifySolution()
    return np.array([joints(state) for state in setup.getSolutionPath().getStates()])


def main() -> None:
    """Print the way from above the bar to a place below it."""
    util.setLogLevel(util.LogLevel.LOG_ERROR)
    util.RNG.setSeed(3)
    home = a5.named_pose("home")
    start, goal = (a5.inverse_kinematics(end).best(home) for end in ENDS)
    for row in np.degrees(way(start, goal)):
        print("  ".join(f"{angle:6.1f}" for angle in row))


if __name__ == "__main__":
    main()
