"""The one tree of errors.

Every error is an :class:`Alpha5Error` and also the built-in that fits, so that both
``except Alpha5Error`` and ``except ValueError`` do what a caller expects. Messages are
one line that names what was given, what was expected and, where there is a choice, the
possible choices.
"""

from __future__ import annotations

import math
import pickle
from collections.abc import Iterable, Iterator, Mapping
from contextlib import contextmanager
from typing import Any

#: Longest message in characters; the middle of a longer one is left out.
_LONGEST = 1000


class Alpha5Error(Exception):
    """Root of all errors of this package.

    Each one can be copied and pickled, message and attributes included, and so reaches
    the caller of a worker process; an attribute that cannot be pickled arrives as its
    printed form.
    """

    def __init__(self, message: str) -> None:
        # Names and paths may hold newlines or be very long.
        line = " ".join(message.split())
        if len(line) > _LONGEST:
            line = f"{line[:700]} ... {line[-200:]}"
        super().__init__(line)

    def __reduce__(self) -> tuple[Any, ...]:
        attributes = {name: _picklable(value) for name, value in vars(self).items()}
        return _restored, (type(self), self.args, attributes)


class ImplausibleWarning(UserWarning):
    """A quantity that is possible, but most likely given in another unit.

    It is given when an object is made. ``warnings.simplefilter("ignore",
    ImplausibleWarning)`` silences it; the bounds stand in
    `alpha5_model.numbers.plausibility`.
    """


class InputError(Alpha5Error, ValueError):
    """A value that cannot be used.

    Attributes:
        name: Name of the argument.
        value: What was given.
        expected: What is taken instead.
    """

    def __init__(self, name: str, value: Any, expected: str) -> None:
        self.name = name
        self.value = value
        self.expected = expected
        super().__init__(f"{name}: {self.problem}")

    @property
    def problem(self) -> str:
        """What was expected and what was given, without the name."""
        return f"expected {self.expected}, got {_short(self.value)}"


class ShapeError(InputError):
    """An array of the wrong shape. ``value`` is the shape that was given."""


class NonFiniteError(InputError):
    """NaN or infinity instead of a finite number. ``index`` is the first bad place."""

    def __init__(self, name: str, value: Any, index: tuple[int, ...]) -> None:
        self.index = index
        place = f"{name}[{', '.join(map(str, index))}]" if index else name
        super().__init__(place, value, "finite numbers")
        self.name = name


class UnknownNameError(Alpha5Error, ValueError):
    """A frame, joint, correction, format or branch that does not exist.

    Attributes:
        kind: What was looked up, for example ``"frame"``.
        name: The name that was given.
        choices: The names that exist.
    """

    def __init__(self, kind: str, name: Any, choices: Iterable[str]) -> None:
        self.kind = kind
        self.name = name
        self.choices = tuple(choices)
        super().__init__(
            f"unknown {kind} {_short(name)}; choose from {', '.join(self.choices)}"
        )


class JointLimitError(Alpha5Error, ValueError):
    """A joint position, speed or torque beyond its bound.

    Attributes:
        joint: Name of the joint.
        value: What was given.
        bound: The bound that it passes.
    """

    def __init__(
        self, joint: str, value: float, bound: float, unit: str = "rad"
    ) -> None:
        self.joint = joint
        self.value = value
        self.bound = bound
        side = "above the upper" if value > bound else "below the lower"
        super().__init__(
            f"{joint}: {value:.6g} {unit} is {side} limit {bound:.6g} {unit}"
        )


class UnreachableError(Alpha5Error, ValueError):
    """A target that no joint position within the limits reaches.

    Attributes:
        position: The target, (3,) [m].
        distance: Distance from the target to the nearest reachable point [m]; NaN if
            it is not known, for a tool beside the wrist axis.
        nearest: That point, (3,) [m]; NaN if it is not known.
    """

    def __init__(
        self, position: Any, distance: float, nearest: Any, reason: str = ""
    ) -> None:
        self.position = position
        self.distance = distance
        self.nearest = nearest
        message = f"{_metres(position)} cannot be reached{reason}"
        if not math.isnan(distance):
            message += (
                f": the nearest reachable point {_metres(nearest)} "
                f"is {distance * 1e3:.3g} mm away"
            )
        super().__init__(message)


class SelfCollisionError(UnreachableError):
    """A target that the arm reaches within its limits only by touching itself.

    Attributes:
        position: The target, (3,) [m].
        links: Names of the two links that touch.
        depth: How deep they overlap [m]; NaN if the package coal is not installed.
        wrist: The nearest theta_3 that reaches the target freely [rad]; NaN if there is
            none.
        yaw: The least turn of the target about the yaw axis that frees it [rad]; NaN if
            none was found.
        nearest, distance: NaN, since no free point near the target is searched.
    """

    def __init__(
        self,
        position: Any,
        *,
        links: tuple[str, str],
        depth: float,
        wrist: float = math.nan,
        yaw: float = math.nan,
        place: str = "",
    ) -> None:
        self.position = position
        self.links = links
        self.depth = depth
        self.wrist = wrist
        self.yaw = yaw
        self.nearest = (math.nan, math.nan, math.nan)
        self.distance = math.nan

        remedies = []
        if not math.isnan(wrist):
            remedies.append(f"theta_3 = {wrist:.4g} rad is free")
        elif not math.isnan(yaw):
            remedies.append(f"turned by {yaw:.4g} rad about the yaw axis it is free")
        overlap = f"{links[0]} and {links[1]} overlap"
        if not math.isnan(depth):
            overlap += f" by {depth * 1e3:.3g} mm"
        Alpha5Error.__init__(
            self,
            f"{_metres(position)} cannot be reached without self-collision{place}: "
            + "; ".join([overlap, *remedies]),
        )


class DiscontinuousPathError(Alpha5Error, ValueError):
    """A path of points that no continuous joint motion within the limits follows.

    Attributes:
        index: The first point without a continuation; None on a line that the caller
            gave by its ends.
        position: That point, (3,) [m].
        step: Least joint step that would lead there [rad].
        max_step: The step allowed [rad].
    """

    def __init__(
        self, index: int | None, position: Any, step: float, max_step: float
    ) -> None:
        self.index = index
        self.position = position
        self.step = step
        self.max_step = max_step
        point = "the line at" if index is None else f"positions[{index}] ="
        super().__init__(
            f"{point} {_metres(position)} has no allowed continuation: "
            f"a joint would have to jump by {step:.3g} rad, "
            f"allowed are {max_step:.3g} rad"
        )


class BlockedMotionError(Alpha5Error, ValueError):
    """A motion for which no way without collision was found.

    Attributes:
        names: What collides: two links, or an obstacle and a link.
        q: Joint position at which it does, (4,) [rad].
        distance: Between the two there [m]; at most 0 if they touch.
        needed: The distance that would be enough [m].
    """

    def __init__(
        self,
        problem: str,
        names: tuple[str, str],
        q: Any,
        distance: float,
        needed: float = 0.0,
    ) -> None:
        self.names = names
        self.q = q
        self.distance = distance
        self.needed = needed
        angles = ", ".join(f"{angle:.4g}" for angle in q)
        gap = f"{distance * 1e3:.3g} mm apart"
        if distance < needed:
            gap += f", less than {needed * 1e3:.3g} mm,"
        if distance <= 0.0:
            gap = f"{-distance * 1e3:.3g} mm deep in each other"
        super().__init__(
            f"{problem}: {names[0]} and {names[1]} are {gap} at ({angles}) rad"
        )


class MotionLimitError(Alpha5Error, ValueError):
    """A motion that is beyond a limit at any speed.

    Attributes:
        joint: Name of the joint.
        quantity: ``speed``, ``torque``, ``current`` or ``voltage``.
        value: What the motion needs.
        bound: The limit.
    """

    def __init__(
        self, joint: str, quantity: str, value: float, bound: float, unit: str
    ) -> None:
        self.joint = joint
        self.quantity = quantity
        self.value = value
        self.bound = bound
        super().__init__(
            f"{joint}: the motion needs a {quantity} of {value:.4g} {unit} at any "
            f"speed, its limit is {bound:.4g} {unit}"
        )


class NoPlacementError(Alpha5Error, ValueError):
    """Points that the arm cannot reach from any of the tried poses of its vehicle.

    Attributes:
        tried: How many poses were tried.
        reaching: How many of them reach all points.
        beyond: By how much the best pose fails to reach one of the points [m]; 0 if
            some pose reaches them all.
        needed: The clearance that was asked for [m].
        possible: A clearance that some pose keeps [m], the largest one if there is one
            point; NaN if each pose that reaches the points touches something.
        touching: If each touches something, at how many poses what does -> their
            number; a pose counts once, for the first that was found.
    """

    def __init__(
        self,
        tried: int,
        reaching: int,
        beyond: float,
        needed: float,
        possible: float,
        touching: Mapping[str, int],
    ) -> None:
        self.tried = tried
        self.reaching = reaching
        self.beyond = beyond
        self.needed = needed
        self.possible = possible
        self.touching = touching
        if not reaching:
            message = f"none of {tried} poses reaches all points"
            message += f": the best is {beyond * 1e3:.3g} mm short of one"
        elif math.isnan(possible):
            message = f"at each of {reaching} poses that reach all points (of {tried}) "
            message += "something touches: "
            counts = [f"{what} at {n}" for what, n in touching.items() if n]
            message += f"{', '.join(counts)}. Try more poses, or move these apart"
            if touching.get("arm and itself or hull"):
                message += "; the hull's places are in base_link"
        else:
            message = f"none of {reaching} poses that reach all points (of {tried}) "
            message += f"keeps a clearance of {needed * 1e3:.4g} mm"
            # Rounded down, so that a pose keeps what is printed.
            kept = math.floor(possible * 1e4) / 10
            message += f": one keeps {kept:g} mm"
        super().__init__(message)


class MissingParameterError(Alpha5Error, ValueError):
    """A quantity that the documents do not give and the caller has not given either."""

    def __init__(self, parameter: str, needed_for: str) -> None:
        self.parameter = parameter
        super().__init__(
            f"{needed_for} needs {parameter}, which is not published: give it yourself"
        )


class MissingFileError(Alpha5Error, FileNotFoundError):
    """A file or folder that is not there."""

    def __init__(self, path: Any, expected: str) -> None:
        self.path = path
        super().__init__(f"{path}: no such file; expected {expected}")


class FileFormatError(Alpha5Error, ValueError):
    """A file that cannot be read. ``place`` says where: line, column or element."""

    def __init__(self, path: Any, problem: str, place: str = "") -> None:
        self.path = path
        self.place = place
        where = f"{path}, {place}" if place else f"{path}"
        super().__init__(f"{where}: {problem}")


class KernelError(Alpha5Error, RuntimeError):
    """A kernel that computed nothing, because its input was not checked: our fault.

    Attributes:
        kernel: Name of the kernel.
    """

    def __init__(self, kernel: str, expected: str) -> None:
        self.kernel = kernel
        super().__init__(f"the kernel {kernel} takes {expected}; please report this")


class OutputError(Alpha5Error, OSError):
    """Output that could not be written; nothing is left half-written."""

    def __init__(self, path: Any, problem: str) -> None:
        self.path = path
        super().__init__(f"cannot write {path}: {problem}")


class ViewerError(Alpha5Error, OSError):
    """A live viewer that cannot start, is closed, or does not answer in time."""


class MissingDependencyError(Alpha5Error, ImportError):
    """An optional package or program that is not installed."""

    def __init__(self, dependency: str, needed_for: str, remedy: str) -> None:
        super().__init__(
            f"{needed_for} needs {dependency}, which is not installed: {remedy}"
        )


@contextmanager
def needing(needed_for: str, remedy: str, dependency: str = "") -> Iterator[None]:
    """A context in which a failed import raises `MissingDependencyError`.

    Args:
        needed_for: What needs the package.
        remedy: How to install it.
        dependency: Its name; that of the missing module if not given.
    """
    try:
        yield
    except ImportError as error:
        missing = dependency or str(error.name)
        raise MissingDependencyError(missing, needed_for, remedy) from None


def _metres(point: Iterable[float]) -> str:
    coordinates = ", ".join(f"{coordinate:.6g}" for coordinate in point)
    return f"({coordinates}) m"


def _restored(
    kind: type[Alpha5Error], args: tuple[Any, ...], attributes: dict[str, Any]
) -> Any:
    """An unpickled error, whose ``__init__`` takes other arguments than the message."""
    error = kind.__new__(kind)
    # The built-in's, which also keeps its own fields.
    super(Alpha5Error, error).__init__(*args)
    vars(error).update(attributes)
    return error


def _picklable(value: Any) -> Any:
    """The value, or its printed form if it cannot be pickled."""
    try:
        pickle.loads(pickle.dumps(value))
    except Exception:
        return _short(value)
    return value


def _short(value: Any) -> str:
    """The printed form of a value on one line of at most 80 characters."""
    try:
        # Arrays print over several lines.
        text = " ".join(repr(value).split())
    except Exception:
        # A foreign class whose repr fails must not hide the error to report.
        text = f"an object of the class {type(value).__name__}"
    return text if len(text) <= 80 else text[:77] + "..."
