"""A serial arm as a chain of Denavit-Hartenberg links."""

from __future__ import annotations

import math
import os
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field
from itertools import pairwise
from typing import TYPE_CHECKING, Any, Literal

import numpy as np
from numpy.typing import ArrayLike

from alpha5_model._support.checks import (
    FloatArray,
    bounded,
    float_array,
    instance,
    listed,
    rigid_transform,
    shaped,
)
from alpha5_model._support.spatial import transform
from alpha5_model.errors import InputError, ShapeError, UnknownNameError
from alpha5_model.numbers.corrections import DEFAULT_CORRECTIONS
from alpha5_model.numbers.parameters import Alpha5Parameters, chosen_arm
from alpha5_model.theory.dh.frames import (
    axes_of_model,
    frames_on_axes,
    table_row,
)
from alpha5_model.theory.dh.link import DHLink, dh_transform

if TYPE_CHECKING:
    import pinocchio as pin

#: A frame of a chain: the number j of {j}, or the tool.
Frame = int | Literal["tool"]


@dataclass(frozen=True, eq=False)
class DHChain:
    """A serial arm in standard DH parameters.

    Attributes:
        links: One `DHLink` per joint, base to tip; at least one.
        base: transform_0_to_world, (4, 4): the pose of frame {0}; read-only.
        tool: transform_tool_to_N, (4, 4): the tool in the last frame; read-only.
            Constant rows at the end of a printed table belong here.
        name: For messages and tables.
        joint_names: One per joint; ``joint_1`` and so on by default.

    Raises:
        InputError: No links, something that is not a `DHLink`, or a base or tool that
            is not a rigid transform.
    """

    links: tuple[DHLink, ...]
    base: FloatArray = field(default_factory=lambda: np.eye(4))
    tool: FloatArray = field(default_factory=lambda: np.eye(4))
    name: str = "dh_chain"
    joint_names: tuple[str, ...] = ()

    def __post_init__(self) -> None:
        links = tuple(listed("links", self.links, "at least one DHLink"))
        if not links:
            raise InputError("links", self.links, "at least one DHLink")
        for link in links:
            if not isinstance(link, DHLink):
                raise InputError("links", link, "DHLink rows (see DHLink.from_vector)")
        object.__setattr__(self, "links", links)

        instance("name", self.name, str)
        expected = f"{len(links)} different names"
        names = tuple(listed("joint_names", self.joint_names, expected))
        if not names:
            names = tuple(f"joint_{j}" for j in range(1, len(links) + 1))
        different = {name for name in names if isinstance(name, str)}
        if not len(different) == len(names) == len(links):
            raise InputError("joint_names", names, expected)
        object.__setattr__(self, "joint_names", names)
        for part in ("base", "tool"):
            object.__setattr__(self, part, rigid_transform(part, getattr(self, part)))

    @classmethod
    def from_table(cls, rows: Sequence[ArrayLike], **options: Any) -> DHChain:
        """A chain from rows ``[theta, d, a, alpha, sigma]``.

        Options are those of `DHChain`.
        """
        table = listed("rows", rows, "rows [theta, d, a, alpha, sigma]")
        return cls(tuple(DHLink.from_vector(row) for row in table), **options)

    @classmethod
    def alpha5(
        cls,
        corrections: Iterable[str] = DEFAULT_CORRECTIONS,
        arm: Alpha5Parameters | None = None,
    ) -> DHChain:
        """The Reach Alpha 5 by [ReachAlpha, Table 1], with four joints.

        The tool is the record's, or else the fixed last row. Frame {0} is
        ``base_link``, and the tool is ``tcp``, DH frame {5}.

        Args:
            corrections: Recorded corrections to the document.
            arm: Record of an arm of your own, which has its corrections already; None
                for the catalogue's.

        Raises:
            InputError: An ``arm`` together with corrections that it does not have.
            UnknownNameError: A correction that is not recorded.
        """
        record = chosen_arm(arm, corrections)
        joints = {joint.dh_variable: joint for joint in record.joints}
        links = []
        names = []
        tool = np.eye(4)
        for row in record.dh:
            if row.variable is None:
                tool = tool @ dh_transform(row.theta_offset, row.d, row.a, row.alpha)
                continue
            joint = joints[row.variable]
            link = DHLink(
                theta=0.0,
                d=row.d,
                a=row.a,
                alpha=row.alpha,
                sigma=0,
                offset=row.theta_offset,
                lower=joint.lower,
                upper=joint.upper,
            )
            links.append(link)
            names.append(joint.name)

        if record.tool is not None:
            # The record has it in link_4, from which the wrist's row leads to {4}.
            wrist = links[-1]
            frame_4_in_link_4 = dh_transform(0.0, wrist.d, wrist.a, wrist.alpha)
            tool_in_link_4 = transform(record.tool.rotation, record.tool.position)
            tool = np.linalg.inv(frame_4_in_link_4) @ tool_in_link_4
        return cls(tuple(links), tool=tool, name="alpha5", joint_names=tuple(names))

    @classmethod
    def from_pinocchio(cls, model: pin.Model, frame: str | None = None) -> DHChain:
        """The chain from a pin.Model's root to one of its frames.

        Joint variables, their zero and their sign are the model's. Joints off the chain
        stay at zero.

        Args:
            model: pin.Model; not changed.
            frame: End effector; by default the last body frame of the last joint.

        Raises:
            UnknownNameError: No such frame.
            InputError: A joint on the chain that is helical or has not exactly one
                degree of freedom; or no joint at all.
        """
        return cls.from_axes(**axes_of_model(model, frame))

    @classmethod
    def from_urdf(
        cls, path: str | os.PathLike[str], frame: str | None = None
    ) -> DHChain:
        """The chain from a URDF's root to a link; see `from_pinocchio`.

        Raises:
            InputError, MissingFileError, FileFormatError: The file cannot be read, or
                Pinocchio refuses it. The message names the line or quotes Pinocchio.
        """
        from alpha5_model.description.pinocchio_model import urdf_model

        return cls.from_pinocchio(urdf_model(path), frame)

    @classmethod
    def from_axes(
        cls,
        points: ArrayLike,
        directions: ArrayLike,
        sigma: ArrayLike | None = None,
        end_effector: ArrayLike | None = None,
        q: ArrayLike | None = None,
        limits: Sequence[tuple[float, float]] | None = None,
        **options: Any,
    ) -> DHChain:
        """A chain from its joint axes, drawn at one configuration, which is its home.

        The frames are those of `alpha5_model.theory.dh.frames`.

        Args:
            points: A point on each joint axis, (N, 3) in the world [m].
            directions: Direction of each axis, (N, 3), of any length but zero.
            sigma: Joint types, 0 revolute (default) and 1 prismatic, (N,).
            end_effector: transform_end_effector_to_world, (4, 4); by default {N} is
                {N-1} without its joint, and the table ends with a row of zeros.
            q: Joint position at which the axes are drawn, (N,) [rad or m]. Each link
                then gets an offset, ``theta = q + offset``. By default the joint
                variable is theta or d itself.
            limits: (lower, upper) of each joint variable, (N, 2).
            options: ``name`` and ``joint_names`` of the chain.

        Raises:
            InputError: No axes, a direction of zero length, shapes that do not fit.
        """
        p = bounded("points", float_array("points", points, (3,)))
        z = float_array("directions", directions, (3,))
        if p.ndim != 2 or len(p) == 0 or z.shape != p.shape:
            raise ShapeError(
                "points, directions", (p.shape, z.shape), "(N, 3) both, N at least 1"
            )
        number = len(p)
        largest = np.abs(z).max(axis=-1, keepdims=True)
        if not largest.all():
            raise InputError("directions", directions, "directions that are not zero")
        z = z / largest  # squares of large numbers overflow
        z /= np.linalg.norm(z, axis=-1, keepdims=True)
        types = np.zeros(number)
        if sigma is not None:
            types = shaped("sigma", sigma, (number,))
        drawn = None if q is None else shaped("q", q, (number,))
        pairs = [[-math.inf, math.inf]] * number
        if limits is not None:
            expected = f"(lower, upper) of each of {number} joints"
            rows = listed("limits", limits, expected)
            pairs = [listed("limits", row, expected) for row in rows]
            if [len(pair) for pair in pairs] != [2] * number:
                raise ShapeError("limits", (len(pairs),), expected)
        end = None
        if end_effector is not None:
            end = rigid_transform("end_effector", end_effector)
            bounded("end_effector", end)

        frames = frames_on_axes(p, z, end)
        links = []
        for j, (frame, following) in enumerate(pairwise(frames)):
            theta, d, a, alpha = table_row(np.linalg.inv(frame) @ following)
            slides = bool(types[j])
            variable = d if slides else theta
            home = variable if drawn is None else float(drawn[j])
            lower, upper = pairs[j]
            link = DHLink(
                theta=theta if slides else home,
                d=home if slides else d,
                a=a,
                alpha=alpha,
                sigma=types[j],
                offset=variable - home,
                lower=lower,
                upper=upper,
            )
            links.append(link)

        tool = np.eye(4)
        if end is not None:
            tool = np.linalg.inv(frames[-1]) @ end
            u, _, vt = np.linalg.svd(tool[:3, :3])
            tool[:3, :3] = u @ vt  # exactly orthonormal
        return cls(links=tuple(links), base=frames[0], tool=tool, **options)

    @property
    def n(self) -> int:
        """Number of joints."""
        return len(self.links)

    @property
    def sigma(self) -> tuple[int, ...]:
        """Joint types, 0 revolute and 1 prismatic, base to tip."""
        return tuple(link.sigma for link in self.links)

    @property
    def home(self) -> FloatArray:
        """Joint position at which the table is drawn, (N,) [rad or m]."""
        return np.array([link.home for link in self.links])

    @property
    def lower(self) -> FloatArray:
        """Lower joint limits, (N,) [rad or m], -inf if there is none."""
        return np.array([link.lower for link in self.links])

    @property
    def upper(self) -> FloatArray:
        """Upper joint limits, (N,) [rad or m], inf if there is none."""
        return np.array([link.upper for link in self.links])

    def frames(self, q: ArrayLike) -> FloatArray:
        """All frames {0} ... {N} and the tool, in the world.

        Args:
            q: (..., N) [rad or m].

        Returns:
            (..., N + 2, 4, 4).
        """
        position = float_array("q", q, (self.n,))
        out = np.empty((*position.shape[:-1], self.n + 2, 4, 4))
        out[..., 0, :, :] = self.base
        for j, link in enumerate(self.links):
            step = link.transform(position[..., j])
            np.matmul(out[..., j, :, :], step, out=out[..., j + 1, :, :])
        np.matmul(out[..., self.n, :, :], self.tool, out=out[..., self.n + 1, :, :])
        return out

    def forward_kinematics(self, q: ArrayLike, frame: Frame = "tool") -> FloatArray:
        """Pose of one frame in the world; `frames` gives all.

        Args:
            q: (..., N) [rad or m].
            frame: j for frame {j}, 0 to N, or ``"tool"``.

        Returns:
            transform_frame_to_world, (..., 4, 4).

        Raises:
            UnknownNameError: No such frame.
        """
        return np.ascontiguousarray(self.frames(q)[..., self._index(frame), :, :])

    def joint_axes(self, q: ArrayLike) -> tuple[FloatArray, FloatArray]:
        """The axes of joints 1 to N in the world: origins and z axes of {0} to {N-1}.

        Args:
            q: (..., N) [rad or m].

        Returns:
            Points (..., N, 3) [m] and unit directions (..., N, 3).
        """
        frames = self.frames(q)[..., : self.n, :, :]
        return frames[..., :3, 3].copy(), frames[..., :3, 2].copy()

    def jacobian(self, q: ArrayLike, frame: Frame = "tool") -> FloatArray:
        """Geometric Jacobian [Siciliano2009, 3.1.3].

        Linear rows first: velocity of the frame's origin, then angular velocity, both
        in the axes of the world (Pinocchio's ``LOCAL_WORLD_ALIGNED``).

        Args:
            q: (..., N) [rad or m].
            frame: j for frame {j}, 0 to N, or ``"tool"``.

        Returns:
            (..., 6, N); columns of joints beyond the frame are zero.
        """
        index = self._index(frame)
        frames = self.frames(q)
        tip = frames[..., index, :3, 3]
        z = frames[..., : self.n, :3, 2]
        points = frames[..., : self.n, :3, 3]
        turns = np.array(self.sigma)[:, None] == 0
        linear = np.where(turns, np.cross(z, tip[..., None, :] - points), z)
        angular = np.where(turns, z, 0.0)
        columns = np.concatenate([linear, angular], axis=-1)
        columns[..., index:, :] = 0.0
        return np.ascontiguousarray(np.swapaxes(columns, -1, -2))

    def _index(self, frame: Frame) -> int:
        if isinstance(frame, str) and frame == "tool":
            return self.n + 1
        number = isinstance(frame, int | np.integer) and not isinstance(frame, bool)
        if not number or not 0 <= int(frame) <= self.n:
            numbers = [str(j) for j in range(self.n + 1)]
            raise UnknownNameError("frame", frame, [*numbers, "tool"])
        return int(frame)
