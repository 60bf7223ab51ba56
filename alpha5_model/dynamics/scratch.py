"""The memory in which Pinocchio computes for an arm."""

from __future__ import annotations

import threading
from functools import cached_property
from typing import Any

import pinocchio as pin


class Scratch(threading.local):
    """The memory that Pinocchio computes in, one set for each thread.

    Attributes:
        data, fluid_data: pin.Data of the arm and of the fluid.
        placements: pin.SE3 of each frame. They are views of `data`, which the next
            computation changes.
    """

    def __init__(self, model: pin.Model, fluid: pin.Model, callers: pin.Model) -> None:
        """Make the memory of a thread.

        Args:
            model: pin.Model of the arm.
            fluid: pin.Model of the displaced fluid.
            callers: pin.Model for the caller, `Arm.model`.
        """
        self.data = model.createData()
        self.fluid_data = fluid.createData()
        self.placements = [self.data.oMf[i] for i in range(model.nframes)]
        self._model = model
        self._callers = callers
        self._pools: dict[int, Any] = {}

    @cached_property
    def callers_data(self) -> Any:
        """pin.Data of the caller's own model, made on first use."""
        return self._callers.createData()

    def pool(self, model: pin.Model, threads: int = 1) -> pin.ModelPool:
        """pin.ModelPool of a model for at least this number of threads.

        The model must outlive this object, because its identity is the key.
        """
        pool = self._pools.get(id(model))
        if pool is None or pool.size() < threads:
            pool = pin.ModelPool(model, threads)
            self._pools[id(model)] = pool
        return pool
