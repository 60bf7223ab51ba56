"""Pages of the arm, and what each prints at a pose, beside Python's numbers."""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np
import own_arm_dynamics
from browser import Tab, open_scene

import alpha5_model as a5
from alpha5_model.numbers.fluids import AIR
from alpha5_model.numbers.hydrodynamics import LEVELS
from alpha5_model.viewer.build import build_scene
from alpha5_model.viewer.scene import Payload

CURRENT = (0.3, -0.4, 0.2)
PAYLOAD = Payload(mass=0.3, com=(0.01, 0.0, 0.02), volume=5e-5)
#: Roll and pitch of the mount.
ATTITUDE = (2.5, -0.6)
PAGES = ("air", "mount", "current", "recording", "spacer", "own mount")


@dataclass
class Case:
    """A page, and the arm whose numbers it must print.

    Attributes:
        arm: With the payload that the page has.
        opened: Arguments of `build_scene` beside the arm without payload.
        bare: That arm.
        changed: Entries of the page's state that a hand sets after it has opened.
        current: Velocity of the water, or None.
    """

    arm: a5.Arm
    bare: a5.Arm
    opened: Mapping[str, Any] = field(default_factory=dict)
    changed: Mapping[str, Any] = field(default_factory=dict)
    current: tuple[float, ...] | None = None


def case(name: str) -> Case:
    """One of `PAGES`. Half of what can be chosen is chosen on the page itself."""
    locked = a5.load()
    jaws = a5.load(gripper="jaws")
    if name == "locked":
        return Case(arm=locked, bare=locked)
    if name == "air":
        return Case(arm=a5.load(AIR), bare=locked, changed={"density": AIR})
    if name == "mount":
        tilted = a5.load(gravity=_gravity(*ATTITUDE), gripper="jaws")
        return Case(arm=tilted, bare=jaws, changed={"attitude": ATTITUDE})
    if name == "current":
        return Case(
            arm=_loaded(a5.load(gravity=_gravity(*ATTITUDE))),
            bare=a5.load(gravity=_gravity(*ATTITUDE)),
            opened={"payload": PAYLOAD, "water_velocity": CURRENT},
            current=CURRENT,
        )
    if name == "recording":
        return Case(
            arm=jaws,
            bare=jaws,
            opened={"motion": _motion()},
            changed={"current": CURRENT},
            current=CURRENT,
        )
    record = own_arm_dynamics.RECORDS[{"spacer": 1, "own mount": 9}[name]]
    own = a5.load(gripper="jaws", arm=record)
    return Case(arm=_loaded(own), bare=own, opened={"payload": PAYLOAD})


def _loaded(arm: a5.Arm) -> a5.Arm:
    return arm.with_payload(PAYLOAD.mass, PAYLOAD.com, volume=PAYLOAD.volume)


def _gravity(roll: float, pitch: float) -> np.ndarray:
    """Gravity in base_link, from the rotations one by one."""
    about_x = np.array(
        [
            [1, 0, 0],
            [0, np.cos(roll), -np.sin(roll)],
            [0, np.sin(roll), np.cos(roll)],
        ]
    )
    about_y = np.array(
        [
            [np.cos(pitch), 0, np.sin(pitch)],
            [0, 1, 0],
            [-np.sin(pitch), 0, np.cos(pitch)],
        ]
    )
    return (about_y @ about_x).T @ [0.0, 0.0, -9.81]


def _motion() -> Any:
    time = np.linspace(0.0, 2.0, 21)
    home = a5.named_pose("home")
    return a5.trajectory.motion(time, home + 0.1 * np.sin(time)[:, None])


def opened(chromium: Any, one: Case, folder: Path) -> Tab:
    """The page of a case, with what a hand changes on it."""
    tab = open_scene(chromium, build_scene(one.bare, **one.opened), folder)
    script = """([part, flows]) => {
      alpha5.change(part);
      alpha5.change({ shown: { current: flows } });
    }"""
    changed = {name: _listed(value) for name, value in one.changed.items()}
    tab.run(script, [changed, one.current is not None])
    return tab


def _listed(value: Any) -> Any:
    return list(value) if isinstance(value, tuple) else value


def poses(one: Case, count: int, seed: int) -> np.ndarray:
    """Random poses within the limits, (count, nq)."""
    limits = one.arm.limits
    rng = np.random.default_rng(seed)
    return rng.uniform(limits.lower, limits.upper, (count, len(limits.lower)))


def printed(tab: Tab, q: np.ndarray) -> list[dict[str, str]]:
    """What the page prints at each pose: texts by name, with plain minus signs."""
    rows = tab.run(
        """(rows) => rows.map((q) => {
          alpha5.change({ q });
          const texts = (selector) =>
            [...document.querySelectorAll(selector)].map((each) => each.textContent);
          const fields = [...document.querySelectorAll('#joints input[type=number]')];
          return {
            holds: texts('.torque'),
            angles: fields.map((each) => each.value),
            tcp: texts('#readout')[0],
            bars: texts('#bars output'),
            payload: texts('#payload summary span')[0],
            forces: texts('#water p')[0],
            carrier: texts('#rest-load')[0],
          };
        })""",
        q.tolist(),
    )
    return [_plain(row) for row in rows]


def _plain(row: dict[str, Any]) -> dict[str, str]:
    joined = {
        name: " ".join(text) if isinstance(text, list) else text
        for name, text in row.items()
    }
    return {name: text.replace("\u2212", "-") for name, text in joined.items()}


def expected(one: Case, q: np.ndarray) -> Iterator[dict[str, str]]:
    """The same texts by Python."""
    for row in q:
        torques = _torques(one, row)
        tcp = 1e3 * one.arm.forward_kinematics(row).translation
        degrees = [f"{np.degrees(angle):.2f}" for angle in row[:4]]
        rod = [f"{1e3 * value:.2f}" for value in row[4:]]
        yield {
            "holds": " ".join(_held(each) for each in torques[:, :4].T)
            + (f" tips {_opening(one, row)} mm apart" if len(row) > 4 else ""),
            "angles": " ".join(degrees + rod),
            "tcp": "tcp  " + "  ".join(_axes(tcp)) + " mm",
            "bars": " ".join(_digits(np.abs(each).max(), 3) for each in torques.T[:4]),
            "payload": _payload(one),
            "forces": _forces(one),
            "carrier": _carrier(one, row),
        }


def _opening(one: Case, q: np.ndarray) -> str:
    """Distance of the finger tips [mm], by Pinocchio's frames."""
    jaws = one.arm.parameters.jaws
    tip = np.array([jaws.pivot_offset, jaws.finger_length, 0.0])
    ends = [
        one.arm.forward_kinematics(q, name).act(sign * tip)
        for name, sign in (("finger_1", 1.0), ("finger_2", -1.0))
    ]
    return _digits(1e3 * np.linalg.norm(ends[0] - ends[1]), 1)


def _torques(one: Case, q: np.ndarray) -> np.ndarray:
    """Holding torques at the levels low, nominal and high of a current, (3, n)."""
    still = np.zeros_like(q)
    if one.current is None:
        return np.tile(one.arm.hydrostatic_torque(q), (3, 1))
    return np.array(
        [
            one.arm.with_hydrodynamics(one.current, level).inverse_dynamics(
                q, still, still
            )
            for level in LEVELS
        ]
    )


def _held(levels: np.ndarray) -> str:
    """``holds`` of one joint, from its three levels."""
    ends = [_digits(end, 3) for end in (levels.min(), levels.max())]
    interval = "" if ends[0] == ends[1] else f" ({' to '.join(ends)})"
    return f"holds {_digits(levels[1], 3)}{interval} N\u00b7m"


def _axes(tcp: np.ndarray) -> list[str]:
    return [f"{name} {_digits(x, 1)}" for name, x in zip("xyz", tcp, strict=True)]


def _payload(one: Case) -> str:
    if one.arm is one.bare or not ("payload" in one.opened or "payload" in one.changed):
        return "none"
    force = (PAYLOAD.mass - one.arm.fluid_density * PAYLOAD.volume) * 9.81
    return f"{1e3 * PAYLOAD.mass:.0f} g, {_digits(force, 2)} N"


def _forces(one: Case) -> str:
    """Weight and buoyancy of the arm without its payload."""
    mass = sum(body.mass for body in one.bare.model.inertias)
    lift = sum(fluid.mass for fluid in one.bare.fluid_model.inertias)
    density = one.arm.fluid_density
    scale = density / one.bare.fluid_density if one.bare.fluid_density else 0.0
    text = f"Arm: weight {_digits(9.81 * mass, 2)} N"
    if density:
        text += f", buoyancy {_digits(9.81 * lift * scale, 2)} N"
        return text + ". The load of a current is estimated, with its interval."
    return text + ". In air a current has no load here."


def _carrier(one: Case, q: np.ndarray) -> str:
    """Force and moment on the mount, at rest and without a current."""
    still = np.zeros_like(q)
    load = one.arm.base_wrench(q, still, still)
    force = _components(load.linear, 2)
    moment = _components(load.angular, 3)
    but = "" if one.current is None else ", without what the current adds"
    return (
        f"Load on the carrier at rest: force {force} N, moment {moment} N\u00b7m{but}."
    )


def _components(values: np.ndarray, count: int) -> str:
    return " ".join(
        f"{name} {_digits(value, count)}"
        for name, value in zip("xyz", values, strict=True)
    )


def _digits(value: float, count: int) -> str:
    """A number with decimals, without minus zero, as the page writes it."""
    text = f"{value:.{count}f}"
    return re.sub(r"^-(0\.?0*)$", r"\1", text)


def differences(tab: Tab, one: Case, q: np.ndarray) -> tuple[int, list[str]]:
    """How many texts were compared, and those that differ."""
    count = 0
    wrong = []
    for found, wanted in zip(printed(tab, q), expected(one, q), strict=True):
        for name, text in wanted.items():
            count += 1
            if found[name].strip() != text.strip():
                wrong.append(f"{name}: {found[name]!r} for {text!r}")
    return count, wrong
