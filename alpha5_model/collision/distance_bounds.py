"""Distances of the shapes of two bodies, and lower bounds of them over a cell.

A cell is a box of joint positions with centre c and half widths h. Three bounds, from
the quickest to the sharpest:

1. At c, boxes around both shapes are apart by at least the largest gap along one of
   their six face normals. The shapes are farther apart, and over the cell nearer by at
   most ``sum_j L_j h_j`` (`alpha5_model.collision.turning_radii`).
2. The same with coal's distance at c.
3. For any unit vector n of the first body, shape A is below ``max_A n.y`` along n, and
   so ``d(q) >= min_B n.x(q) - max_A n.y``. Of Taylor's polynomial of n.x(q),

       n.x(q) = n.x(c) + sum_j e_j n.(z_j x (x - p_j)) + rest,   e = q - c,

   the part without the rest is linear in x and in e. Its least value over A, B and the
   cell is at a corner of the cell, where it is a support function of B. The second
   derivative by joints i <= j is ``z_i x (z_j x (x - p_j))``, no longer than the
   distance of x from axis j. So the rest is at most
   ``1/2 sum_ij R_max(i,j) h_i h_j``, R_j being B's largest distance from axis j.
   n is the direction between coal's nearest points, but the bound holds for any.

The third one decides pairs that pass each other closely: its error falls with the
square of the cell's size.

References:
    [Gottschalk1996] Gottschalk, Lin, Manocha: OBBTree, SIGGRAPH 1996 (separating axes).
"""

from __future__ import annotations

import itertools
from typing import NamedTuple, TypeAlias

import coal
import numpy as np
from numpy.typing import NDArray

from alpha5_model._support.checks import BoolArray, FloatArray
from alpha5_model.collision.link_chain import BodyPair, frames_along

#: A direction for shapes whose nearest points coincide.
_ANY = (1.0, 0.0, 0.0)
_TINY = float(np.finfo(np.float64).tiny)

IntArray: TypeAlias = NDArray[np.intp]


class Cells(NamedTuple):
    """Boxes of joint positions.

    Attributes:
        centre: (n, m).
        half: Half widths, (n, m).
    """

    centre: FloatArray
    half: FloatArray


class PlacedPairs(NamedTuple):
    """Pairs of shapes at joint positions, in the first body.

    Attributes:
        first, second: Numbers of the shapes, (k,).
        centre: Of the second shape, (k, 3).
        rotation: Of the second shape, (k, 3, 3).
    """

    first: IntArray
    second: IntArray
    centre: FloatArray
    rotation: FloatArray

    def only(self, chosen: BoolArray) -> PlacedPairs:
        """Some of the pairs."""
        return PlacedPairs(
            first=self.first[chosen],
            second=self.second[chosen],
            centre=self.centre[chosen],
            rotation=self.rotation[chosen],
        )


class PairDistances:
    """Distances of the shapes of two bodies.

    Attributes:
        radii: L_j of each pair, (first, second, m).
    """

    def __init__(self, bodies: BodyPair) -> None:
        """Prepare the shapes of two bodies."""
        self._joints = bodies.joints
        self._first = bodies.first
        self._second = bodies.second
        self._second_radii = bodies.second_radii
        self.radii = bodies.rates
        self._fixed = [
            coal.Transform3s(rotation, centre)
            for rotation, centre in zip(
                self._first.rotation, self._first.centre, strict=True
            )
        ]
        self._request = coal.DistanceRequest()

    def frames(self, q: FloatArray) -> FloatArray:
        """Poses of the frames that the joints turn at q (n, m), (n, m, 4, 4)."""
        return frames_along(self._joints, q)

    def placed(
        self, frame: FloatArray, first: IntArray, second: IntArray
    ) -> PlacedPairs:
        """Pairs of shapes with the second body at poses (k, 4, 4)."""
        rotation = frame[:, :3, :3]
        centre = self._second.centre[second]
        turned = np.einsum("nij,nj->ni", rotation, centre)
        return PlacedPairs(
            first=first,
            second=second,
            centre=turned + frame[:, :3, 3],
            rotation=rotation @ self._second.rotation[second],
        )

    def of_boxes(self, pairs: PlacedPairs) -> FloatArray:
        """Lower bounds of the distances, (k,): gaps along face normals of boxes."""
        rotation = self._first.rotation[pairs.first]
        half_1 = self._first.half[pairs.first]
        half_2 = self._second.half[pairs.second]
        apart = pairs.centre - self._first.centre[pairs.first]
        relative = np.einsum("nji,njk->nik", rotation, pairs.rotation)
        size = np.abs(relative)

        along_1 = np.abs(np.einsum("nji,nj->ni", rotation, apart))
        along_2 = np.abs(np.einsum("nji,nj->ni", pairs.rotation, apart))
        gaps_1 = along_1 - half_1 - np.einsum("nij,nj->ni", size, half_2)
        gaps_2 = along_2 - half_2 - np.einsum("nij,ni->nj", size, half_1)
        return np.asarray(np.maximum(gaps_1.max(axis=1), gaps_2.max(axis=1)))

    def of_coal(self, pairs: PlacedPairs) -> tuple[FloatArray, FloatArray]:
        """coal's distances (k,), and vectors between the nearest points, (k, 3)."""
        distances = np.empty(len(pairs.first))
        between = np.empty((len(pairs.first), 3))
        result = coal.DistanceResult()
        for i, (a, b) in enumerate(
            zip(pairs.first.tolist(), pairs.second.tolist(), strict=True)
        ):
            # A fresh result each time: a search never starts from the last one.
            result.clear()
            distances[i] = coal.distance(
                self._first.solids[a],
                self._fixed[a],
                self._second.solids[b],
                coal.Transform3s(pairs.rotation[i], pairs.centre[i]),
                self._request,
                result,
            )
            between[i] = result.getNearestPoint2() - result.getNearestPoint1()
        return distances, between

    def by_taylor(
        self,
        pairs: PlacedPairs,
        frames: FloatArray,
        half: FloatArray,
        direction: FloatArray,
    ) -> FloatArray:
        """The third bound.

        Args:
            pairs: At the centres of their cells.
            frames: Of the joints there, (k, m, 4, 4).
            half: Half widths of the cells, (k, m).
            direction: Of n, (k, 3), of any length.

        Returns:
            (k,).
        """
        length = np.linalg.norm(direction, axis=1, keepdims=True)
        n = np.where(length > 0.0, direction / np.maximum(length, _TINY), _ANY)
        # n.(z_j x (x - p_j)) h_j = slope_j.(x - p_j)
        slope = half[..., None] * np.cross(n[:, None], frames[..., :3, 2])
        of_origins = np.einsum("njk,njk->nj", slope, frames[..., :3, 3])
        corners = np.array([*itertools.product((-1.0, 1.0), repeat=half.shape[1])])

        # At each corner of the cell the polynomial is g.x minus a number.
        g = n[:, None] + np.einsum("sj,njk->nsk", corners, slope)
        number = np.einsum("sj,nj->ns", corners, of_origins)
        lowest = self._lowest_of_second(pairs, g) - number
        rest = self._rest(pairs.second, half)
        return np.asarray(lowest.min(axis=1) - self._highest_of_first(pairs, n) - rest)

    def _lowest_of_second(self, pairs: PlacedPairs, g: FloatArray) -> FloatArray:
        """Least g.x over the second shapes, (k, s), for vectors (k, s, 3)."""
        inside = np.einsum("nij,nsi->nsj", pairs.rotation, g)
        half = self._second.half[pairs.second][:, None]
        is_cylinder = self._second.is_cylinder[pairs.second][:, None]
        middle = np.einsum("nsk,nk->ns", g, pairs.centre)
        return np.asarray(middle - _support(half, is_cylinder, inside))

    def _highest_of_first(self, pairs: PlacedPairs, n: FloatArray) -> FloatArray:
        """Largest n.y over the first shapes, (k,)."""
        inside = np.einsum("nji,nj->ni", self._first.rotation[pairs.first], n)
        half = self._first.half[pairs.first]
        is_cylinder = self._first.is_cylinder[pairs.first]
        middle = np.einsum("ni,ni->n", self._first.centre[pairs.first], n)
        return np.asarray(middle + _support(half, is_cylinder, inside))

    def _rest(self, second: IntArray, half: FloatArray) -> FloatArray:
        """Bound of the rest of Taylor's polynomial, (k,)."""
        joint = np.arange(half.shape[1])
        farther = np.maximum(joint[:, None], joint)
        radius = self._second_radii[second][:, farther]
        return np.asarray(0.5 * np.einsum("nij,ni,nj->n", radius, half, half))


def _support(half: FloatArray, is_cylinder: BoolArray, u: FloatArray) -> FloatArray:
    """Support function of boxes and cylinders at their centres along u (..., 3)."""
    size = np.abs(u)
    of_box = np.sum(half * size, axis=-1)
    across = np.hypot(u[..., 0], u[..., 1])
    of_cylinder = half[..., 0] * across + half[..., 2] * size[..., 2]
    return np.where(is_cylinder, of_cylinder, of_box)
