"""Inverse kinematics against its peers: one target, a batch, and what an import costs.

Every candidate gets the same targets, the tcp positions (for EAIK: the whole poses) of
random joint positions within the limits. An iterative solver starts once, from the
middle of the ranges. A target counts as solved where forward kinematics comes within
1e-6 m of it; where a candidate knows joint limits, within the limits.
"""

from __future__ import annotations

import subprocess
import sys
from collections.abc import Callable
from importlib.util import find_spec
from typing import Any

import numpy as np
from benchmarks.timing import Row, measure

import alpha5_model as a5

ONE, BATCH, IMPORT = "IK of one position", "IK of 100 000 positions", "import"
SOLVED = 1e-6
#: Targets of one timed call: enough to average over easy and hard ones.
COUNT = 50
STEPS = 200

PEERS = {
    "EAIK": "eaik",
    "roboticstoolbox-python": "roboticstoolbox",
    "pin-pink": "pink",
}


def missing() -> list[str]:
    """Peers that are not installed."""
    return [name for name, module in PEERS.items() if find_spec(module) is None]


def rows() -> list[Row]:
    """Measured rows of this section."""
    return [*_one(), *_batch(), *_imports()]


def _sample(count: int) -> tuple[np.ndarray, np.ndarray]:
    """Random joint positions within the limits, and the poses of the tcp."""
    chain = a5.dh.DHChain.alpha5()
    q = np.random.default_rng(7).uniform(chain.lower, chain.upper, (count, 4))
    return q, chain.forward_kinematics(q)


def _one() -> list[Row]:
    _, poses = _sample(COUNT)
    targets = [np.ascontiguousarray(pose[:3, 3]) for pose in poses]
    solvers: dict[str, tuple[Callable[[int], Any], str]] = {
        "alpha5-model": (
            lambda i: a5.inverse_kinematics(targets[i]),
            "a5.inverse_kinematics: four branches, wrapped, with flags",
        )
    }
    if find_spec("eaik"):
        robot, frames = _eaik(poses)
        solvers["EAIK"] = (
            lambda i: robot.IK(frames[i]).Q,
            "DhRobot from Table 1, whole pose, solutions read; knows no joint limits",
        )
    solvers["Pinocchio CLIK"] = (
        _clik(targets),
        "damped least squares on the tcp's position, damping 1e-6, "
        f"at most {STEPS} steps, clipped to the limits",
    )
    if find_spec("roboticstoolbox"):
        solvers["roboticstoolbox"] = (
            _toolbox(targets),
            "DHRobot from Table 1, ik_LM (C++), position only, tol 1e-12, "
            "30 iterations, no random restarts, joint limits checked",
        )
    if find_spec("pink"):
        solvers["pin-pink"] = (
            _pink(targets),
            "FrameTask on the tcp's position, ConfigurationLimit, DAQP, "
            f"at most {STEPS} steps",
        )
    chosen = range(COUNT)
    seconds = measure(
        {name: lambda f=f: [f(i) for i in chosen] for name, (f, _) in solvers.items()},
        per_call=COUNT,
        rounds=5,
    )
    success = {name: _success(name, f, poses) for name, (f, _) in solvers.items()}
    wanted = {"EAIK": 4.0}
    return [
        Row(ONE, name, seconds[name], success[name], setup, wanted.get(name))
        for name, (_, setup) in solvers.items()
    ]


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
    count = 100_000
    _, poses = _sample(count)
    targets = np.ascontiguousarray(poses[:, :3, 3])
    functions: dict[str, Callable[[], object]] = {
        "alpha5-model": lambda: a5.inverse_kinematics(targets)
    }
    if find_spec("eaik"):
        robot, _ = _eaik(poses[:1])
        frames = np.ascontiguousarray(
            poses @ np.linalg.inv(a5.dh.DHChain.alpha5().tool)
        )
        functions["EAIK batched"] = lambda: robot.IK_batched(frames)
    seconds = measure(functions, per_call=count)
    setups = {
        "alpha5-model": "four branches, wrapped, with flags, on one core",
        "EAIK batched": "IK_batched, four threads, whole poses",
    }
    wanted = {"EAIK batched": 50.0}
    return [
        Row(BATCH, name, seconds[name], None, setups[name], wanted.get(name))
        for name in seconds
    ]


def _imports() -> list[Row]:
    def run(module: str) -> Callable[[], object]:
        command = [sys.executable, "-c", f"import {module}"]
        return lambda: subprocess.run(command, check=True)

    modules = {"alpha5_model.kinematics.ik": None, "numpy": 1 / 1.3}
    if find_spec("roboticstoolbox"):
        modules["roboticstoolbox"] = None
    seconds = measure({module: run(module) for module in modules}, rounds=11)
    return [
        Row(IMPORT, module, seconds[module], target=modules[module])
        for module in modules
    ]
