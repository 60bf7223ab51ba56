"""Arms and random states for the tests of the dynamics."""

from __future__ import annotations

from itertools import product
from typing import Any

import numpy as np
import pinocchio as pin

import alpha5_model as a5

TILTED = (1.7, -2.3, -9.4)
PAYLOAD = {
    "mass": 0.6,
    "com": (0.01, -0.02, 0.05),
    "inertia": ((4e-4, 1e-5, -2e-5), (1e-5, 5e-4, 3e-5), (-2e-5, 3e-5, 6e-4)),
    "volume": 2.3e-4,
    "cob": (-0.01, 0.015, 0.04),
}
#: Every kind of arm: joints, base, fluid, load, gravity.
VARIANTS: dict[str, dict[str, Any]] = {
    "locked": {},
    "locked, air, tilted": {"fluid_density": a5.AIR, "gravity": TILTED},
    "locked, payload, tilted": {"gravity": TILTED, "payload": PAYLOAD},
    "to the letter": {"corrections": ()},
    "floating": {"floating_base": True},
    "floating, air, payload": {
        "floating_base": True,
        "fluid_density": 0.0,
        "payload": PAYLOAD,
    },
    "jaws": {"gripper": "jaws", "gravity": TILTED},
    "jaws, payload": {"gripper": "jaws", "payload": {**PAYLOAD, "frame": "finger_1"}},
    "jaws, floating, payload": {
        "gripper": "jaws",
        "floating_base": True,
        "payload": PAYLOAD,
    },
}


def payload_of_net_weight(ratio: float, density: float) -> dict[str, Any]:
    """A body whose net weight in the fluid is ``ratio`` times one of its two weights.

    Below 0 that is its own weight, above 0 the displaced fluid's.
    """
    displaced = 0.1 * (1 - min(ratio, 0.0))  # kg
    cob = PAYLOAD["cob"] if ratio else PAYLOAD["com"]  # neutral in every way
    volume = displaced / (density or 1000.0)
    mass = displaced + ratio * 0.1
    return {"mass": mass, "volume": volume, "com": PAYLOAD["com"], "cob": cob}


#: For each gripper and base, a body's ratio of net weight in each fluid.
#: The bodies float or sink, in fluids from none to heavier than mercury.
def _floating_variants() -> dict[str, dict[str, Any]]:
    densities = (0.0, 1e-3, 1000.0, 1025.0, 5000.0, 2e4)
    ratios = (-5.0, 5.0, -1.0, 0.0, 1.0, -0.2)
    variants = {}
    for k, (gripper, floating) in enumerate(product(("locked", "jaws"), (False, True))):
        base = "floating" if floating else "fixed"
        for i, density in enumerate(densities):
            ratio = ratios[(i + 2 * k) % len(ratios)]
            variants[f"{gripper}, {base}, {density:g} kg/m^3, net {ratio:+g}"] = {
                "gripper": gripper,
                "floating_base": floating,
                "fluid_density": density,
                "gravity": TILTED,
                "payload": payload_of_net_weight(ratio, density),
            }
    return variants


FLOATING = _floating_variants()


def make(variant: str) -> a5.Arm:
    choices = dict((VARIANTS | FLOATING)[variant])
    payload = choices.pop("payload", None)
    arm = a5.load(**choices)
    return arm.with_payload(**payload) if payload else arm


def random_q(arm: a5.Arm, rng: np.random.Generator) -> np.ndarray:
    q = rng.uniform(-np.pi, np.pi, arm.model.nq)
    if "axis_a" in arm.joint_names:
        q[-1] = rng.uniform(0.0013, 0.0133)
    if arm.floating_base:
        q[3:7] = rng.normal(size=4)
        q[3:7] /= np.linalg.norm(q[3:7])
    return q


def random_v(arm: a5.Arm, rng: np.random.Generator, scale: float = 1.0) -> np.ndarray:
    v = rng.normal(scale=scale, size=arm.model.nv)
    if "axis_a" in arm.joint_names:
        v[-1] *= 0.02  # metres, where the others are radians
    return v


def moved(arm: a5.Arm, q: np.ndarray, dq: np.ndarray) -> np.ndarray:
    """q moved along a tangent vector; a floating base moves in base_link's axes."""
    if not arm.floating_base:
        return q + dq
    base = pin.XYZQUATToSE3(q[:7]) * pin.exp6(pin.Motion(dq[:6]))
    return np.concatenate([pin.SE3ToXYZQUAT(base), q[7:] + dq[6:]])


def central_difference(
    function: Any, arm: a5.Arm, q: np.ndarray, step: float, *rest: Any
) -> np.ndarray:
    """Columns: derivatives of function(q, *rest) along the tangent coordinates."""
    columns = []
    for i in range(arm.model.nv):
        h = step * (
            0.02 if arm.model.nv - i == 1 and "axis_a" in arm.joint_names else 1.0
        )
        dq = np.zeros(arm.model.nv)
        dq[i] = h
        ahead, behind = (function(moved(arm, q, s * dq), *rest) for s in (1.0, -1.0))
        columns.append((ahead - behind) / (2 * h))
    return np.stack(columns, axis=-1)


def close(ours: Any, reference: Any, relative: float) -> None:
    """Equal to a share of the reference's largest entry, or of 1 if that is more."""
    scale = max(1.0, float(np.abs(reference).max()))
    assert np.abs(np.asarray(ours) - reference).max() < relative * scale
