"""The exact test and distances by the compiled kernels, if they are installed."""

from __future__ import annotations

from collections.abc import Callable
from functools import partial
from typing import Any

import numpy as np

from alpha5_model._support.checks import BoolArray, FloatArray
from alpha5_model.codegen.kernels.choice import module
from alpha5_model.collision.bodies import CollisionBodies, body_numbers, shape_numbers
from alpha5_model.collision.cells import Cells
from alpha5_model.collision.cells_file import packed, table_numbers
from alpha5_model.errors import KernelError


def is_compiled() -> bool:
    """Whether the compiled kernels run."""
    return hasattr(module(), "scene")


class CompiledScene:
    """The bodies of an arm as the compiled kernels take them.

    Threads may share it.
    """

    def __init__(self, bodies: CollisionBodies, tables: tuple[Cells, ...] = ()) -> None:
        numbers = [
            item
            for cells in tables
            for item in (table_numbers(cells, bodies.pairs), packed(cells.codes))
        ]
        self._kernels = module()
        self._scene = self._kernels.scene(
            body_numbers(bodies),
            shape_numbers(bodies),
            np.array(bodies.pairs, np.float64).reshape(-1, 2),
            *numbers,
        )

    def one(self) -> Callable[[Any, float], bool | None]:
        """A function of angles (B-1,) and a margin; None if they are not plainly so."""
        return partial(self._kernels.self_collision, self._scene)

    def best_solution(self) -> Callable[[Any, Any, bool], FloatArray | None]:
        """A function of the solutions of a target, a reference and a permission.

        It returns the nearest valid one, (4,). If something is not plainly so, if no
        solution will do, or if theta_0 may be free, it returns None.
        """
        return partial(self._kernels.best_solution, self._scene)

    def touches(
        self, angles: FloatArray, margin: float, asked: BoolArray | None
    ) -> BoolArray:
        """Whether the arm comes within a margin of itself, (N,); not where NaN is.

        Rows that are not asked for do not either.
        """
        hits = np.empty(len(angles), np.bool_)
        done = self._kernels.self_collision_rows(
            self._scene, angles, margin, asked, hits
        )
        _check("self_collision_rows", done)
        return hits

    def nearest(self, angles: FloatArray) -> FloatArray:
        """Distance, two shapes and their points in link_0, (N, 9)."""
        found = np.empty((len(angles), 9))
        done = self._kernels.nearest_bodies_rows(self._scene, angles, found)
        _check("nearest_bodies_rows", done)
        return found

    def free_shares(
        self, rates: FloatArray, start: FloatArray, end: FloatArray, margin: float
    ) -> FloatArray:
        """How much of the lines between rows is proved free, (N,)."""
        shares = np.empty(len(start))
        done = self._kernels.free_shares(self._scene, rates, start, end, margin, shares)
        _check("free_shares", done)
        return shares


def _check(kernel: str, done: bool) -> None:
    """Refuse what a kernel did not write.

    Raises:
        KernelError: It wrote nothing.
    """
    if not done:
        raise KernelError(kernel)
