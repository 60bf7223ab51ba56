"""Options that several commands have, and the arm that they describe."""

from __future__ import annotations

from argparse import ArgumentTypeError, Namespace
from collections.abc import Iterable, Sequence
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from alpha5_model._support.spatial import rotation_from_rpy
from alpha5_model.cli.parsing import Parser
from alpha5_model.cli.quantities import (
    ANGLE,
    CURRENT,
    DENSITY,
    GRAVITY,
    LENGTH,
    MASS,
    SPEED,
    VOLTAGE,
    VOLUME,
    Scalar,
    Vector,
    joints,
)
from alpha5_model.errors import InputError
from alpha5_model.numbers.fluids import FLUIDS, gravity_in_base

if TYPE_CHECKING:
    from alpha5_model.dynamics.arm import Arm
    from alpha5_model.numbers.jaws import Gripper
    from alpha5_model.numbers.parameters import Alpha5Parameters

#: Poses with a name, see `alpha5_model.named_pose`.
NAMED_POSES = ("stow", "home", "reach")
#: The turning joints, for helps.
JOINTS = "axis_e, axis_d, axis_c, axis_b"
DOWN = "0 0 -9.81"
FLUID = "sea (1025), fresh (1000), air (0) or a density (kg/m^3)"
_DENSITY = Scalar(DENSITY, f"{', '.join(FLUIDS)} or a density (kg/m^3)")
_PAYLOAD = "MASS, MASS X Y Z or MASS X Y Z VOLUME (kg, m, m^3)"


def density(text: str) -> float:
    """The type of ``--fluid``: a density [kg/m^3]."""
    if text.strip() in FLUIDS:
        return FLUIDS[text.strip()]
    value = _DENSITY(text)
    if value < 0:
        raise ArgumentTypeError(f"expected a density of at least 0, got {text}")
    return value


#: The type of a joint position.
POSITION = joints(ANGLE, LENGTH, NAMED_POSES)


def joint_position(given: Any, arm: Arm, own: Alpha5Parameters | None) -> list[float]:
    """The same for each joint of an arm; the jaws are closed if nothing is said.

    Raises:
        InputError: A number for jaws that are locked.
    """
    q = position_of(given, own)
    q += arm.limits.lower[len(q) :].tolist()
    if len(q) > len(arm.joint_names):
        raise InputError("q", q, "four numbers, or --gripper jaws")
    return q


def position_of(given: Any, own: Alpha5Parameters | None) -> list[float]:
    """The numbers of a `POSITION`; those of a named pose keep the limits of an arm."""
    if not isinstance(given, str):
        return list(given)
    from alpha5_model.description.srdf import named_pose

    return [float(angle) for angle in named_pose(given, own)]


def as_json(
    parser: Parser, words: str = "print everything as JSON, in SI units"
) -> None:
    parser.add_argument("--json", action="store_true", help=words)


def arm_file(parser: Parser) -> None:
    parser.add_argument(
        "--arm",
        type=Path,
        metavar="FILE",
        help="your own arm: a file as alpha5 arm writes it. Default: the catalogue's",
    )


def fluid(parser: Parser, default: str = "sea", dest: str = "fluid") -> None:
    """``--fluid``; ``dest`` is the name of its density in what is given."""
    parser.add_argument(
        "--fluid",
        dest=dest,
        metavar="FLUID",
        type=density,
        default=default,
        help=f"{FLUID}. Default: %(default)s",
    )


def gravity(parser: Parser, default: str | None = DOWN, words: str = "") -> None:
    parser.add_argument(
        "--gravity",
        type=Vector(GRAVITY, GRAVITY, GRAVITY),
        default=default,
        metavar="X Y Z",
        help=words or "in base_link (m/s^2); with --mount, in the world",
    )


def gripper(parser: Parser, default: str = "locked") -> None:
    parser.add_argument(
        "--gripper",
        default=default,
        help="locked (4 joints) or jaws (adds the jaw rod axis_a). "
        "Default: %(default)s",
    )


def mount(parser: Parser) -> None:
    parser.add_argument(
        "--mount",
        type=Vector(ANGLE, ANGLE, ANGLE),
        metavar="R P Y",
        help="roll, pitch, yaw of base_link in the world, z up (rad). "
        "Default: 0 0 0, or the mount of --arm",
    )


def payload(parser: Parser) -> None:
    parser.add_argument(
        "--payload",
        type=Vector(
            MASS, LENGTH, LENGTH, LENGTH, VOLUME, counts=(1, 4, 5), expected=_PAYLOAD
        ),
        metavar="MASS",
        help="payload at the tcp: mass (kg), then optionally its COM (x y z, m), then "
        "its volume (m^3)",
    )


def water_velocity(
    parser: Parser, words: str = "Adds drag and added mass, estimated"
) -> None:
    parser.add_argument(
        "--water-velocity",
        "--current",
        type=Vector(SPEED, SPEED, SPEED),
        metavar="X Y Z",
        help=f"velocity of the water in base_link (m/s). {words}. "
        "--current is its old name",
    )


def motors(parser: Parser) -> None:
    """``--constants`` and ``--efficiency``."""
    parser.add_argument(
        "--constants",
        help="motor constants: K_t and K_v of the document's Table 4 contradict each "
        "other. printed (K_t for torque, K_v for voltage), torque (K_t for both) or "
        "voltage (K_v for both). Default: printed, or those of --arm",
    )
    parser.add_argument(
        "--efficiency",
        default="gearbox",
        help="gearbox or motor: whose efficiency eta_max of Table 4 is; the table does "
        "not say. Default: %(default)s",
    )


def drives(parser: Parser) -> None:
    """``--supply-voltage`` and ``--current-limit``."""
    parser.add_argument(
        "--supply-voltage",
        type=Scalar(VOLTAGE),
        help="supply voltage of the motors (V); not published",
    )
    parser.add_argument(
        "--current-limit",
        type=Scalar(CURRENT),
        help="current limit of each motor (A); not published",
    )


def reading(parser: Parser) -> None:
    """How the file of a motion is read."""
    parser.add_argument(
        "--topic", help="topic of the joint states, if a bag has several"
    )
    names_in_file(parser)
    parser.add_argument(
        "--time",
        metavar="COLUMN",
        help="column of the time, NAME or NAME:ms (s, ms, us, ns or min)",
    )
    parser.add_argument(
        "--episode", type=int, help="episode of a Parquet file that holds several"
    )


def names_in_file(parser: Parser) -> None:
    """What a file calls the joints, and the unit of their angles."""
    parser.add_argument("--prefix", help="prefix of the joints' names, such as left_")
    parser.add_argument(
        "--map",
        default="",
        help="names of the joints: axis_e=NAME,axis_d=-NAME (turns the other way) and "
        "so on",
    )
    parser.add_argument(
        "--degrees",
        action="store_true",
        help="angles are in degrees, if columns name no unit",
    )


def names_of(given: Namespace) -> dict[str, Any]:
    """The arguments of a reader that the options of `names_in_file` give."""
    return {
        "prefix": given.prefix,
        "joints": joint_names(given.map),
        "degrees": given.degrees,
    }


def reading_of(given: Namespace) -> dict[str, Any]:
    """The arguments of `read_motion` that the options of `reading` give."""
    return {
        **names_of(given),
        "topic": given.topic,
        "time": given.time,
        "episode": given.episode,
    }


def plot(parser: Parser, words: str = "write a picture: .png, .pdf or .svg") -> None:
    parser.add_argument("--plot", type=Path, metavar="FILE", help=words)


def record_of(given: Namespace) -> Alpha5Parameters | None:
    """The record of ``--arm``; None without it.

    Raises:
        Alpha5Error: A file that `arm_file` refuses.
    """
    if given.arm is None:
        return None
    from alpha5_model.numbers import arm_file

    return arm_file.arm_file(given.arm)


def vehicle_tables(file: Path) -> dict[str, Any]:
    """The tables of the TOML file of ``--vehicle``."""
    from alpha5_model._support.files import read_named
    from alpha5_model._support.toml import toml_tables

    text = read_named(file, "the facts of a vehicle (TOML)")
    return toml_tables(text.decode("utf-8-sig", "replace"), str(file))


def arm_of(
    given: Namespace,
    gripper: Gripper,
    record: Alpha5Parameters | None = None,
    payload: bool = True,
) -> Arm:
    """The arm of ``--fluid``, ``--gravity``, ``--mount`` and ``--payload``.

    Args:
        record: Of an arm of one's own; None for the catalogue's. ``--mount`` replaces
            its mount.
        payload: Whether the arm carries the payload.
    """
    from alpha5_model.dynamics.load import load

    g: Any = given.gravity
    if given.mount is not None:
        rotation = rotation_from_rpy(given.mount)
        if not np.array_equal(rotation, np.eye(3)):
            g = gravity_in_base(rotation, g)
        if record is not None:
            record = replace(record, mount=None)
    arm = load(given.fluid, gripper, gravity=g, arm=record)
    if not payload or given.payload is None:
        return arm
    mass, com, volume = payload_of(given.payload)
    return arm.with_payload(mass, com, volume=volume, cob=com)


def payload_of(
    numbers: list[float],
) -> tuple[float, tuple[float, float, float], float]:
    """Mass [kg], centre of mass in tcp (3,) [m] and volume [m^3] of ``--payload``."""
    mass, *more = numbers
    x, y, z = more[:3] or (0.0, 0.0, 0.0)
    volume = more[3] if len(more) > 3 else 0.0
    return mass, (x, y, z), volume


def names(text: str) -> tuple[str, ...]:
    """The type of a list of names: the parts between commas."""
    return tuple(name.strip() for name in text.split(",") if name.strip())


def pairs(
    option: str,
    parts: Iterable[str],
    sign: str,
    form: str = "",
    may_be_empty: bool = False,
) -> dict[str, str]:
    """Names and values, from texts with a sign between the two.

    Args:
        option: The option that has them.
        parts: Texts with one pair each.
        sign: Between name and value.
        form: What was expected, for the error; NAME, the sign and VALUE if empty.
        may_be_empty: Whether a value may be empty.

    Raises:
        InputError: A name without a value, or one that stands twice.
    """
    expected = f"{form or f'NAME{sign}VALUE'} with each name once"
    found: dict[str, str] = {}
    for part in parts:
        if not part.strip():
            continue
        name, equals, value = part.strip().partition(sign)
        complete = name and equals and (value or may_be_empty)
        if not complete or name.strip() in found:
            raise InputError(option, ",".join(parts), expected)
        found[name.strip()] = value.strip()
    return found


def joint_names(text: str) -> dict[str, str]:
    """The names of ``--map``.

    Raises:
        InputError: A joint without a name, or one that stands twice.
    """
    return pairs("map", text.split(","), "=", "axis_e=NAME,axis_d=NAME,...")


def given_only(**values: Any) -> dict[str, Any]:
    """The arguments that are not None: the others keep a function's own default."""
    return {name: value for name, value in values.items() if value is not None}


def beyond_limits(arm: Arm, q: Sequence[float]) -> list[str]:
    """Joints that a position puts beyond their limits."""
    beyond = arm.limits.beyond(np.array(q))
    return [name for name, out in zip(arm.joint_names, beyond, strict=True) if out]
