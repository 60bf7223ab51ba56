"""Inverse kinematics against its peers: one target, a batch, and what an import costs.

Every candidate gets the same targets, the tcp positions (for EAIK: the whole poses) of
random joint positions within the limits. An iterative solver starts once, from the
middle of the ranges. A target counts as solved if forward kinematics comes within
1e-6 m of it; if a candidate knows joint limits, within the limits.
"""

from __future__ import annotations

import subprocess
import sys
from collections.abc import Callable
from dataclasses import replace
from functools import partial
from typing import Any

import numpy as np
from benchmarks.timing import Row, compare, installed

import alpha5_model as a5
from alpha5_model.numbers.pose import Pose

SOLVED = 1e-6
#: Targets of one timed call: enough to average over easy and hard ones.
COUNT = 50
MANY = 100_000
STEPS = 200
#: Beside the wrist axis [m].
TOOL = Pose(position=np.array([0.03, 0.04, -0.21]), rotation=np.eye(3))


def rows() -> list[Row]:
    """Measured rows of this subject."""
    return [*_one(), *_batch(), *_imports(), *_any_arm()]


def _sample(count: int) -> tuple[np.ndarray, np.ndarray]:
    """Random joint positions within the limits, and the poses of the tcp."""
    chain = a5.dh.DHChain.alpha5()
    q = np.random.default_rng(7).uniform(chain.lower, chain.upper, (count, 4))
    return q, chain.forward_kinematics(q)


def _one() -> list[Row]:
    """Each target in a call of its own."""
    _, poses = _sample(COUNT)
    targets = [np.ascontiguousarray(pose[:3, 3]) for pose in poses]
    solvers: dict[str, Callable[[int], Any]] = {
        # four branches, wrapped, with flags
        "alpha5-model": lambda i: a5.inverse_kinematics(targets[i])
    }
    if installed("eaik"):
        # DhRobot from Table 1, whole pose, solutions read; knows no joint limits
        robot, frames = _eaik(poses)
        solvers["EAIK"] = lambda i: robot.IK(frames[i]).Q
    solvers["Pinocchio CLIK"] = _clik(targets)
    if installed("roboticstoolbox"):
        solvers["roboticstoolbox"] = _toolbox(targets)
    if installed("pink"):
        solvers["pin-pink"] = _pink(targets)
    return compare(
        "IK of one position",
        {name: partial(_all, solve) for name, solve in solvers.items()},
        COUNT,
        rounds=5,
        success={name: _success(name, f, poses) for name, f in solvers.items()},
    )


def _all(solve: Callable[[int], Any]) -> list[Any]:
    return [solve(i) for i in range(COUNT)]


def _success(name: str, solve: Callable[[int], Any], poses: np.ndarray) -> float:
    chain = a5.dh.DHChain.alpha5()
    solved = 0
    for i, pose in enumerate(poses):
        answer = solve(i)
        if name == "alpha5-model":
            candidates = answer.q[answer.within_limits]
        elif name == "EAIK":  # theta instead of q
            candidates = np.atleast_2d(answer) - [link.offset for link in chain.links]
        else:
            candidates = np.atleast_2d(answer)
            inside = (candidates >= chain.lower - 1e-9) & (
                candidates <= chain.upper + 1e-9
            )
            candidates = candidates[inside.all(axis=-1)]
        reached = chain.forward_kinematics(candidates)[:, :3, 3]
        solved += bool((np.linalg.norm(reached - pose[:3, 3], axis=-1) < SOLVED).any())
    return solved / len(poses)


def _eaik(poses: np.ndarray) -> tuple[Any, list[np.ndarray]]:
    """EAIK's robot, and the poses of frame {4}, the last that its table has."""
    from eaik.IK_DH import DhRobot

    chain = a5.dh.DHChain.alpha5()
    table = [
        [getattr(link, name) for link in chain.links] for name in ("alpha", "a", "d")
    ]
    frames = poses @ np.linalg.inv(chain.tool)
    return DhRobot(*map(np.array, table)), [
        np.ascontiguousarray(frame) for frame in frames
    ]


def _clik(targets: list[np.ndarray]) -> Callable[[int], np.ndarray]:
    """Damped least squares on the tcp's position, clipped to the limits."""
    import pinocchio as pin

    model = a5.load().model
    data, frame = model.createData(), model.getFrameId("tcp")
    low, high = model.lowerPositionLimit, model.upperPositionLimit
    damping = 1e-6 * np.eye(3)

    def solve(i: int) -> np.ndarray:
        q = (low + high) / 2
        for _ in range(STEPS):
            J = pin.computeFrameJacobian(
                model, data, q, frame, pin.LOCAL_WORLD_ALIGNED
            )[:3]
            error = targets[i] - data.oMf[frame].translation
            if error @ error < SOLVED**2:
                break
            q = np.clip(q + J.T @ np.linalg.solve(J @ J.T + damping, error), low, high)
        return q

    return solve


def _toolbox(targets: list[np.ndarray]) -> Callable[[int], np.ndarray]:
    """DHRobot from Table 1, Levenberg-Marquardt in C++, position only, no restarts."""
    import roboticstoolbox as rtb
    from spatialmath import SE3

    chain = a5.dh.DHChain.alpha5()
    links = [
        rtb.RevoluteDH(
            d=k.d, a=k.a, alpha=k.alpha, offset=k.offset, qlim=[k.lower, k.upper]
        )
        for k in chain.links
    ]
    robot = rtb.DHRobot(links, tool=SE3(chain.tool, check=False)).ets()
    start = (chain.lower + chain.upper) / 2
    wanted = []
    for target in targets:
        pose = np.eye(4)
        pose[:3, 3] = target
        wanted.append(pose)
    mask = np.array([1.0, 1.0, 1.0, 0.0, 0.0, 0.0])

    def solve(i: int) -> np.ndarray:
        return robot.ik_LM(
            wanted[i],
            q0=start,
            ilimit=30,
            slimit=1,
            tol=1e-12,
            mask=mask,
            joint_limits=True,
        )[0]

    return solve


def _pink(targets: list[np.ndarray]) -> Callable[[int], np.ndarray]:
    """FrameTask on the tcp's position, ConfigurationLimit, DAQP."""
    import warnings

    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        import pink
        from pink.limits import ConfigurationLimit
        from pink.tasks import FrameTask
    import pinocchio as pin

    model = a5.load().model
    data = model.createData()
    start = (model.lowerPositionLimit + model.upperPositionLimit) / 2
    limits = [ConfigurationLimit(model)]

    def solve(i: int) -> np.ndarray:
        configuration = pink.Configuration(model, data, start)
        task = FrameTask("tcp", position_cost=1.0, orientation_cost=0.0)
        task.set_target(pin.SE3(np.eye(3), targets[i]))
        for _ in range(STEPS):
            if np.linalg.norm(task.compute_error(configuration)[:3]) < SOLVED:
                break
            velocity = pink.solve_ik(
                configuration, [task], 1.0, solver="daqp", limits=limits
            )
            configuration.integrate_inplace(velocity, 1.0)
        return configuration.q

    return solve


def _batch() -> list[Row]:
    """Ours on one core; EAIK's whole poses on four threads."""
    _, poses = _sample(MANY)
    targets = np.ascontiguousarray(poses[:, :3, 3])
    candidates: dict[str, Callable[[], object]] = {
        "alpha5-model": lambda: a5.inverse_kinematics(targets)
    }
    if installed("eaik"):
        robot, _ = _eaik(poses[:1])
        tool = a5.dh.DHChain.alpha5().tool
        frames = np.ascontiguousarray(poses @ np.linalg.inv(tool))
        candidates["EAIK batched"] = lambda: robot.IK_batched(frames)
    return compare("IK of 100 000 positions", candidates, MANY)


def _imports() -> list[Row]:
    """In new processes."""
    modules = ["alpha5_model.kinematics.ik", "numpy"]
    if installed("roboticstoolbox"):
        modules.append("roboticstoolbox")
    commands = {name: [sys.executable, "-c", f"import {name}"] for name in modules}
    calls = {
        name: partial(subprocess.run, command, check=True)
        for name, command in commands.items()
    }
    return compare("import", calls, rounds=11)


def _any_arm() -> list[Row]:
    """Arms of one's own beside the catalogue's, which has its numbers as constants."""
    printed = a5.parameters()
    dh = list(printed.dh)
    dh[1] = replace(dh[1], a=dh[1].a + 0.01)
    arms = {
        "catalogue's arm": None,
        "own lengths": replace(printed, dh=tuple(dh)),
        "tool beside the axis": replace(printed, tool=TOOL),
    }
    found = []
    for work, count in (("one target", 1), ("100 000 targets", MANY)):
        calls: dict[str, Callable[[], object]] = {}
        success = {}
        for name, arm in arms.items():
            chain = a5.dh.DHChain.alpha5(arm=arm)
            q, _ = _sample(count)
            target = np.ascontiguousarray(chain.forward_kinematics(q)[:, :3, 3])
            wrist = q[:, 3].copy()
            solved = a5.inverse_kinematics(target, wrist, arm=arm)
            success[name] = float(solved.within_limits.any(axis=-1).mean())
            given = (target, wrist) if count > 1 else (target[0], float(wrist[0]))
            calls[name] = partial(a5.inverse_kinematics, *given, arm=arm)
        found += compare(f"IK of any arm: {work}", calls, count, 41, success)
    return found
