"""Room beside a line: what a motion that strays from it may need, and no less."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from own_arm import tips
from reference import LOWER, UPPER, dh_frames

import alpha5_model as a5
from alpha5_model.planning import Obstacle, plan

# `plan` has no argument for this room: it needs it for lines of the TCP only.
from alpha5_model.planning.surroundings import Surroundings

ARM = a5.parameters()
HOME = a5.named_pose("home")
HOLD = np.array(LOWER[:4]), np.array(UPPER[:4])


def test_a_motion_is_slowed_down_no_more_than_a_tenth_too_much() -> None:
    free = plan(HOME, [0.2, 0.2, 0.1])
    fastest = max(p.value for p in free.peaks if p.quantity == "voltage")
    for share in (0.9, 0.5):
        supply = share * fastest
        motion = plan(HOME, [0.2, 0.2, 0.1], supply_voltage=supply, current_limit=1.0)
        assert motion.slowed > 1.0
        reached = np.abs(motion.analysis.voltage).max()
        assert 0.85 * supply < reached <= supply
        longest = motion.slowed * free.duration
        assert 0.9 * longest < motion.duration <= longest


@pytest.mark.slow
def test_room_beside_a_line_is_that_of_the_farthest_points() -> None:
    """Each joint needs its angle times the farthest distance from its axis."""
    rng = np.random.default_rng(1)
    farthest = np.zeros(4)
    for q in rng.uniform(*HOLD, (300, 4)):
        frames = dh_frames(q)
        tip = frames[-1][:3, 3]
        for joint in range(4):
            frame = frames[joint]
            off = np.cross(tip - frame[:3, 3], frame[:3, 2])
            farthest[joint] = max(farthest[joint], np.linalg.norm(off))
    alone = Surroundings(ARM)
    for joint, unit in enumerate(np.eye(4)):
        room = alone.with_room(0.01 * unit).margin / 0.01
        assert farthest[joint] < room < farthest[joint] + 0.06
    strayed = rng.uniform(0.0, 0.01, 4)
    parts = [alone.with_room(one).margin for one in np.diag(strayed)]
    wide = Surroundings(ARM, (), 0.02).with_room(strayed)
    assert wide.margin == pytest.approx(0.02 + sum(parts))


def buoy(q: Any, gap: float) -> Obstacle:
    """A sphere above the tip, with a gap between it and the arm."""
    centre = tips(ARM, q[None])[0] + np.array([0.0, 0.0, 0.1])
    small = Surroundings(ARM, [Obstacle.sphere("buoy", 0.01, centre)])
    (beside, _) = small._compared[1]
    return Obstacle.sphere("buoy", 0.01 + beside.nearest_pair(q)[0] - gap, centre)


def test_room_is_kept_to_obstacles_and_to_the_arm_itself() -> None:
    q = np.array([3.0, 1.5, 2.0, 1.0])
    distance, _ = Surroundings(ARM).nearest(q)
    post = buoy(q, 0.009)
    beside = Surroundings(ARM, [post], 0.004)
    near, names = beside.nearest(q)
    assert "buoy" in names
    unit = np.array([1.0, 0.0, 0.0, 0.0])
    per_radian = Surroundings(ARM).with_room(unit).margin
    for own, gap in ((Surroundings(ARM), distance), (beside, near - 0.004)):
        for share, hit in ((0.99, False), (1.01, True)):
            found = own.with_room(share * gap / per_radian * unit).contact(q)
            assert (found is not None) == hit
            assert found is None or found.share == 0.0
        assert own.contact(q) is None


def test_a_line_of_the_tcp_strays_as_little_as_is_said() -> None:
    pytest.importorskip("toppra")
    from alpha5_model.planning.tcp_line import tcp_line

    start = a5.inverse_kinematics([0.12, 0.2, 0.1]).best(HOME)
    end = np.array([0.14, 0.19, 0.1])
    line = tcp_line(start, end, start[3], a5.load())
    share = np.linspace(0.0, 1.0, len(line.way))
    dense = np.linspace(0.0, 1.0, 40 * (len(share) - 1) + 1)
    straight = np.transpose([np.interp(dense, share, row) for row in line.way.T])
    off = np.abs(line._path(dense) - straight).max(axis=0)
    moving = off > 1e-12
    assert moving.sum() == 3
    ratio = line.deviation[moving] / off[moving]
    assert ratio.min() > 0.99
    assert ratio.max() < 1.2
