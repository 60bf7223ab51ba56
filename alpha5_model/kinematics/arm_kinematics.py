"""The kinematics of one arm, made once from its record."""

from __future__ import annotations

from functools import cached_property
from typing import Any

from numpy.typing import ArrayLike

from alpha5_model._support.checks import BoolArray, FloatArray, flag
from alpha5_model.collision.self_collision import SelfCollision, self_collision
from alpha5_model.kinematics import (
    approach,
    areas,
    boundaries,
    choosing,
    colliding,
    half_plane,
    nearest_points,
    path_search,
    pose_solver,
    reachable_points,
    sampled_shares,
    singular,
    solver,
)
from alpha5_model.kinematics.approach import ApproachDirections
from alpha5_model.kinematics.arcs import Arc
from alpha5_model.kinematics.arm_shape import ArmShape
from alpha5_model.kinematics.hand import Hand
from alpha5_model.kinematics.path_search import MAX_STEP
from alpha5_model.kinematics.plane import ArmPlane
from alpha5_model.kinematics.reachable_points import Accept
from alpha5_model.kinematics.sampled_shares import SampledShare
from alpha5_model.kinematics.singular import Singularities
from alpha5_model.kinematics.solutions import PoseSolutionArrays, SolutionArrays
from alpha5_model.numbers.parameters import Alpha5Parameters


class ArmKinematics:
    """Inverse kinematics, reach and workspace of one arm.

    Lengths, zeros, limits and tool point are the record's. With a tool on the wrist
    axis all methods are exact. With a tool beside it, the inverse kinematics, paths,
    singularities and manipulability are. Poses are searched along theta_3. Reach,
    workspace and approach directions, which are not bounded by arcs then, are refused.

    The functions of the same names in `alpha5_model.kinematics.ik`, ``pose``, ``path``,
    ``reach`` and ``workspace`` are these methods for the catalogue's arm. Their
    docstrings describe arguments, units and errors.

    Attributes:
        parameters: The arm's.
        shape: Its lengths, zeros, limits and tool point.

    Raises:
        PublishedDataError: Not a vertical plane with two links in it.
    """

    def __init__(self, parameters: Alpha5Parameters) -> None:
        self.parameters = parameters
        self.shape = ArmShape.from_parameters(parameters)
        self._wrist = parameters.joints[3]

    @cached_property
    def plane(self) -> ArmPlane:
        """The plane of the arm.

        Raises:
            InputError: A tool beside the wrist axis: there is another plane for each
                theta_3, and the reach is not bounded by arcs.
        """
        return ArmPlane.from_shape(self.shape, "exact reach and workspace")

    @cached_property
    def hand(self) -> Hand:
        """The hand, which orientations and approach directions are about."""
        return Hand.from_parameters(self.parameters)

    @cached_property
    def self_collision(self) -> SelfCollision:
        """Where the arm touches itself, with its jaws closed."""
        return self_collision(self.parameters)

    def _compared(self, allow_collision: bool) -> SelfCollision | None:
        """What solutions are compared with; None if they may collide."""
        if flag("allow_collision", allow_collision):
            return None
        return self.self_collision

    def inverse_kinematics(
        self, position: ArrayLike, wrist: ArrayLike = 0.0
    ) -> SolutionArrays:
        """Every joint position that puts the tcp at a point."""
        return solver.solve(SolutionArrays, position, wrist, self.shape)

    def collides(self, solutions: SolutionArrays | PoseSolutionArrays) -> BoolArray:
        """Which solutions within the limits touch the arm itself."""
        return colliding.collides(solutions, self.self_collision)

    def best(
        self,
        solutions: SolutionArrays,
        q_reference: ArrayLike,
        allow_collision: bool = False,
    ) -> FloatArray:
        """The free solution within the limits that is nearest to a joint position."""
        scene = self._compared(allow_collision)
        return choosing.best(solutions, q_reference, self.shape, self._wrist, scene)

    def inverse_kinematics_pose(self, transform: Any) -> PoseSolutionArrays:
        """Joint positions for a position exactly, and an orientation closely."""
        return pose_solver.solve_poses(self.hand, transform)

    def best_pose(
        self,
        solutions: PoseSolutionArrays,
        q_reference: ArrayLike,
        allow_collision: bool = False,
    ) -> FloatArray:
        """The free solution within the limits with the least rotation error."""
        scene = self._compared(allow_collision)
        return choosing.best_pose(
            solutions, q_reference, self.shape, self._wrist, scene
        )

    def inverse_kinematics_path(
        self,
        positions: ArrayLike,
        q_start: ArrayLike | None = None,
        wrist: ArrayLike | None = None,
        max_step: float = MAX_STEP,
        allow_collision: bool = False,
    ) -> FloatArray:
        """Joint positions along a path of points, continuous, within limits, free."""
        scene = self._compared(allow_collision)
        return path_search.solve_path(
            self.shape, self._wrist, scene, positions, q_start, wrist, max_step
        )

    def approach_directions(self, position: ArrayLike) -> ApproachDirections:
        """The directions from which the arm reaches points."""
        return approach.approach_directions(self.hand, position)

    def reachable(
        self, positions: ArrayLike, limits: bool = True, accept: Accept | None = None
    ) -> BoolArray:
        """Whether the tcp reaches a point."""
        return reachable_points.reachable(self.plane, positions, limits, accept)

    def distance_to_reach(
        self, positions: ArrayLike, limits: bool = True
    ) -> FloatArray:
        """Distance to the nearest reachable point."""
        return nearest_points.distance_to_reach(self.plane, positions, limits)

    def nearest_reachable(
        self, positions: ArrayLike, limits: bool = True
    ) -> FloatArray:
        """The nearest reachable point."""
        return nearest_points.nearest_reachable(self.plane, positions, limits)

    def in_half_plane(
        self,
        radius: FloatArray,
        z: FloatArray,
        side: str = "both",
        limits: bool = True,
    ) -> BoolArray:
        """Which points of a half-plane the arm reaches, theta_0 aside."""
        return half_plane.in_half_plane(self.plane, radius, z, side, limits)

    def boundary(self, side: str = "both", limits: bool = True) -> tuple[Arc, ...]:
        """Boundary arcs of the reachable part of a half-plane."""
        return boundaries.boundary(self.plane, side, limits)

    def cross_section_area(self, side: str = "both", limits: bool = True) -> float:
        """Area of the reachable part of a half-plane through the yaw axis."""
        return areas.cross_section_area(self.plane, side, limits)

    def volume(self, limits: bool = True) -> float:
        """Volume of the reachable set."""
        return areas.volume(self.plane, limits)

    def sampled_share(
        self,
        accept: Accept,
        samples: int,
        seed: int = 0,
        azimuth: float | None = None,
    ) -> SampledShare:
        """Share of the reachable set that is reached in accepted joint positions."""
        return sampled_shares.sampled_share(self.plane, accept, samples, seed, azimuth)

    def singularities(self, q: ArrayLike) -> Singularities:
        """How far joint positions are from the three singular sets."""
        return singular.singularities(self.shape, q)

    def singular_elbow_angles(self) -> dict[str, float]:
        """theta_2 of the stretched and of the folded arm."""
        return singular.singular_elbow_angles(self.plane)

    def manipulability(self, q: ArrayLike) -> FloatArray:
        """Yoshikawa's measure of the tcp's linear motion."""
        return singular.manipulability(self.hand, q)
