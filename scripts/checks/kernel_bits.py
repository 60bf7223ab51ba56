"""Do the kernels give the same bits on two machines?

    python scripts/checks/kernel_bits.py write FILE      # on one
    python scripts/checks/kernel_bits.py compare FILE    # on the other

Needs NumPy alone. FILE (.npz) has inputs and outputs of every kernel at random states,
and of the inverse kinematics at random targets. Exit status 1 if a bit differs, or if
the kernels are not compiled.
"""

from __future__ import annotations

import argparse
import platform
import sys
from collections.abc import Sequence
from pathlib import Path

import numpy as np

import alpha5_model as a5
from alpha5_model.kernels.choice import rows
from alpha5_model.kernels.generated import formulas

ROWS = 500
TARGETS = 2000
#: Kernels that are compiled; JAX alone calls the others.
NAMES = (
    "forward_kinematics",
    "gravity_torque",
    "buoyancy_torque",
    "coriolis_torque",
    "nonlinear_effects",
    "inverse_dynamics",
    "base_wrench",
    "inverse_dynamics_with_base_wrench",
    "forward_dynamics",
)


def inputs() -> dict[str, np.ndarray]:
    """Random inputs of each kernel: ``name/0``, ``name/1``, …, and targets."""
    rng = np.random.default_rng(2026)
    drawn = {"targets": rng.uniform(-0.6, 0.6, (TARGETS, 3))}
    drawn["wrists"] = rng.uniform(0.0, 6.0, TARGETS)
    for name in NAMES:
        *of_states, of_parameters = formulas.KERNELS[name][1]
        drawn[f"{name}/parameters"] = rng.uniform(0.1, 1.0, of_parameters)
        for i, shape in enumerate(of_states):
            drawn[f"{name}/{i}"] = rng.uniform(-3.0, 3.0, (ROWS, *shape))
    return drawn


def outputs(given: dict[str, np.ndarray]) -> dict[str, np.ndarray]:
    """What the kernels of this machine make of the inputs."""
    solutions = a5.inverse_kinematics(given["targets"], given["wrists"])
    made = {
        "targets/q": solutions.q,
        "targets/exists": solutions.exists,
        "targets/within_limits": solutions.within_limits,
        "targets/singular": solutions.singular,
    }
    for name in NAMES:
        count = len(formulas.KERNELS[name][1]) - 1
        arrays = [given[f"{name}/{i}"] for i in range(count)]
        results = rows(name, given[f"{name}/parameters"], *arrays)
        for i, result in enumerate(results):
            made[f"{name}/{i}"] = result
    return {name: with_one_nan(array) for name, array in made.items()}


def with_one_nan(array: np.ndarray) -> np.ndarray:
    """The array with each NaN as NumPy has it: processors make NaN of either sign."""
    if array.dtype.kind != "f":
        return array
    return np.where(np.isnan(array), np.nan, array)


def differing(found: dict[str, np.ndarray], other: dict[str, np.ndarray]) -> list[str]:
    """Names of the outputs whose bits differ."""
    if found.keys() != other.keys():
        raise SystemExit("the other machine has other kernels")
    return [name for name in found if found[name].tobytes() != other[name].tobytes()]


def main(arguments: Sequence[str] | None = None) -> int:
    """Write or compare; returns the exit status."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    parser.add_argument("action", choices=("write", "compare"))
    parser.add_argument(
        "file", type=Path, help="what the other machine computes (.npz)"
    )
    chosen = parser.parse_args(arguments)
    if a5.backend() != "compiled":
        print(f"kernels: {a5.backend()}, expected compiled ones")
        return 1
    machine = f"{platform.machine()}, {a5.backend()}"
    if chosen.action == "write":
        given = inputs()
        made = {f"out/{name}": array for name, array in outputs(given).items()}
        np.savez(chosen.file, **given, **made)
        print(f"{machine}: {len(made)} arrays written")
        return 0

    with np.load(chosen.file) as stored:
        arrays = {name: stored[name] for name in stored.files}
    other = {
        name.removeprefix("out/"): array
        for name, array in arrays.items()
        if name.startswith("out/")
    }
    off = differing(outputs(arrays), other)
    for name in off:
        print(f"{name}: other bits")
    count = sum(array.size for array in other.values())
    print(
        f"{machine}: {len(other) - len(off)} of {len(other)} arrays, {count} numbers, "
        "have the same bits"
    )
    return 1 if off else 0


if __name__ == "__main__":
    sys.exit(main())
