"""Identify the same simulated arms with this package, figaroh and mujoco.sysid.

    python scripts/identification/compare_identification.py write FOLDER
    # In an environment with figaroh and mujoco[sysid]:
    python scripts/identification/compare_identification.py fit FOLDER

``write`` simulates arms in air whose numbers round to the printed ones: a sway of 12 s
within the rated speeds, with 3 mN m of white noise in the efforts. It also fits them
with `a5.calibrate.fit`. ``fit`` needs NumPy, figaroh and mujoco only. Both print
the error of the static torque at 2000 random positions, root mean square over positions
and arms [mN m], for axis_d and axis_c. The others carry no such torque in air, or
hardly any.

- figaroh: the base parameters that its QR decomposition chooses for random states, by
  least squares on the recording.
- mujoco.sysid: pseudo-inertias of four bodies, from the URDF's on, by its SciPy
  optimiser on the efforts of ``mj_inverse``.
"""

from __future__ import annotations

import argparse
import sys
import time
from functools import partial
from pathlib import Path
from typing import Any
from xml.etree import ElementTree as ET

import numpy as np

ARMS = 5
NOISE = 0.003
POSITIONS = 2000
#: Samples that mujoco.sysid fits: every n-th, as it needs finite differences.
EVERY = 10
#: Steps of mujoco.sysid; more change the result by less than the noise does.
STEPS = 10
MODEL = "arm.urdf"
NAMES = ("q", "v", "a", "effort", "positions", "truth")
BODIES = ("link_1", "link_2", "link_3", "link_4")


def main(arguments: list[str] | None = None) -> int:
    """Run a step."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").split("\n", 1)[0])
    parser.add_argument("step", choices=("write", "fit"))
    parser.add_argument("folder", type=Path)
    options = parser.parse_args(arguments)
    if options.step == "write":
        options.folder.mkdir(parents=True, exist_ok=True)
        write(options.folder)
    else:
        fit(options.folder)
    return 0


def report(what: str, errors: list[np.ndarray], seconds: float = 0.0) -> None:
    """Print the errors of a tool."""
    squares = np.mean([(error**2).mean(axis=0) for error in errors], axis=0)
    d, c = 1e3 * np.sqrt(squares[1:3])
    each = f", {seconds / len(errors):.1f} s an arm" if seconds else ""
    print(f"{what:24}{d:8.2f}{c:8.2f}{each}", flush=True)


def write(folder: Path) -> None:
    """Simulate arms, fit them with this package, and write what the others need."""
    import alpha5_model as a5

    c = a5.calibrate
    u = a5.uncertainty
    efforts = c.efforts(noise=NOISE, gain=0.0)
    motion = sway()
    s = a5.trajectory.smooth(motion, "interpolate")
    state = (s.position, s.velocity, s.acceleration)
    rng = np.random.default_rng(1)
    limits = a5.load().limits
    positions = rng.uniform(limits.lower, limits.upper, (POSITIONS, 4))
    rest = np.zeros_like(positions)
    in_air = a5.load(a5.AIR)
    printed = in_air.inverse_dynamics_batch(positions, rest, rest)
    sets = u.sample(ARMS, seed=3, lengths=False)

    of_tables = []
    ours = []
    start = time.perf_counter()
    for k in range(ARMS):
        arm = u.arm(sets.parameters(k), a5.AIR)
        effort = arm.inverse_dynamics_batch(*state)
        effort += rng.normal(scale=NOISE, size=effort.shape)
        truth = arm.inverse_dynamics_batch(positions, rest, rest)
        read = c.session(efforts, s.position, effort, v=s.velocity, a=s.acceleration)
        found = c.fit(read, zeros=0.0, tilt=0.0)
        fitted = u.arm(found.arm, a5.AIR)
        of_tables.append(printed - truth)
        ours.append(fitted.inverse_dynamics_batch(positions, rest, rest) - truth)
        values = zip(NAMES, (*state, effort, positions, truth), strict=True)
        np.savez(folder / f"{k}.npz", **dict(values))
    (folder / MODEL).write_text(_bare_urdf(a5.URDF_PATH), encoding="utf-8")
    print(f"{'':24}{'axis_d':>8}{'axis_c':>8}")
    report("printed tables", of_tables)
    report("alpha5_model.calibrate", ours, time.perf_counter() - start)


def sway() -> Any:
    """The motion, within the rated speeds."""
    import alpha5_model as a5

    times = np.arange(0, 12, 0.02)
    phase = np.outer(times, [1.25, 1.0, 1.3, 1.1])
    swing = a5.named_pose("reach") + [0, 0.5, -0.6, 0] + 0.4 * np.sin(phase)
    return a5.trajectory.motion(times, swing)


def _bare_urdf(path: Path) -> str:
    """The links and joints of a URDF, without shapes."""
    robot = ET.parse(path).getroot()
    for element in [*robot]:
        if element.tag not in ("link", "joint"):
            robot.remove(element)
    for link in robot.iter("link"):
        for shape in [*link.findall("visual"), *link.findall("collision")]:
            link.remove(shape)
    return ET.tostring(robot, encoding="unicode")


def fit(folder: Path) -> None:
    """Fit the arms with the other tools."""
    files = sorted(folder.glob("*.npz"))
    arms = [dict(np.load(file)) for file in files]
    for name, tool in (("figaroh", by_figaroh), ("mujoco.sysid", by_mujoco)):
        start = time.perf_counter()
        errors = [tool(folder / MODEL, arm) - arm["truth"] for arm in arms]
        report(name, errors, time.perf_counter() - start)


def by_figaroh(model: Path, arm: dict[str, np.ndarray]) -> np.ndarray:
    """Static torques by figaroh's base parameters, (n, 4)."""
    import pinocchio as pin
    from figaroh.tools.qrdecomposition import QRDecomposer
    from figaroh.tools.regressor import RegressorBuilder

    robot = pin.RobotWrapper(pin.buildModelFromUrdf(str(model)))
    builder = RegressorBuilder(robot)
    moved = {"act_idxv": range(4)}
    rng = np.random.default_rng(0)
    anything = [rng.uniform(-3, 3, (200, 4)) for _ in range(3)]
    structure = builder.build_basic_regressor(*anything, moved)
    kept = np.flatnonzero((structure**2).sum(axis=0) > 1e-6)
    names = [f"p{k}" for k in kept]
    decomposer = QRDecomposer()
    decomposer.double_decomposition(
        np.zeros(len(structure)), structure[:, kept], names, dict.fromkeys(names, 0.0)
    )
    base = kept[decomposer.get_base_indices()]

    rows = builder.build_basic_regressor(arm["q"], arm["v"], arm["a"], moved)
    effort = arm["effort"].T.ravel()  # joint by joint, as the regressor
    fitted, *_ = np.linalg.lstsq(rows[:, base], effort, rcond=None)
    rest = np.zeros_like(arm["positions"])
    static = builder.build_basic_regressor(arm["positions"], rest, rest, moved)
    return np.asarray((static[:, base] @ fitted).reshape(4, -1).T)


def by_mujoco(model: Path, arm: dict[str, np.ndarray]) -> np.ndarray:
    """Static torques by mujoco.sysid's pseudo-inertias, (n, 4)."""
    import mujoco
    from mujoco import sysid

    spec = mujoco.MjSpec.from_file(str(model))
    spec.compiler.fusestatic = False
    compiled = spec.compile()
    unknowns = sysid.ParameterDict()
    for body in BODIES:
        kind = sysid.InertiaType.Pseudo
        changed = partial(_with_inertia, body)
        unknowns.add(
            sysid.body_inertia_param(spec, compiled, body, kind, modifier=changed)
        )
    chosen = slice(None, None, EVERY)
    states = [arm[name][chosen] for name in ("q", "v", "a")]
    effort = arm["effort"][chosen]

    def residual(x: np.ndarray, parameters: Any, **_: Any) -> Any:
        parameters.update_from_vector(x)
        now = sysid.apply_param_modifiers(parameters, spec)
        left = (torques(now, *states) - effort).ravel() / NOISE
        return [left], None, None

    settings: dict[str, Any] = {"max_iters": STEPS}
    found, _ = sysid.optimize(unknowns, residual, "scipy", verbose=False, **settings)
    rest = np.zeros_like(arm["positions"])
    final = sysid.apply_param_modifiers(found, spec)
    return torques(final, arm["positions"], rest, rest)


def _with_inertia(name: str, spec: Any, parameter: Any) -> Any:
    """A model with the pseudo-inertia of a body.

    mujoco 4.0.0 asks for a turn of the inertia's axes that its compiler refuses: NaN.
    """
    from mujoco import sysid

    sysid.apply_body_inertia(spec, name, parameter)
    spec.body(name).iquat[:] = 1.0, 0.0, 0.0, 0.0
    return spec


def torques(model: Any, q: np.ndarray, v: np.ndarray, a: np.ndarray) -> np.ndarray:
    """Inverse dynamics by MuJoCo, (n, 4)."""
    import mujoco

    data = mujoco.MjData(model)
    rows = []
    for position, velocity, acceleration in zip(q, v, a, strict=True):
        data.qpos[:] = position
        data.qvel[:] = velocity
        data.qacc[:] = acceleration
        mujoco.mj_inverse(model, data)
        rows.append(data.qfrc_inverse.copy())
    return np.array(rows)


if __name__ == "__main__":
    sys.exit(main())
