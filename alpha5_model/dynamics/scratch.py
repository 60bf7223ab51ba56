"""The memory that Pinocchio computes in."""

from __future__ import annotations

import threading
from functools import cached_property
from typing import Any

from alpha5_model.dynamics import batch
from alpha5_model.dynamics.collision import CollisionModel


class Scratch(threading.local):
    """pin.Data of the arm, of the fluid and of their difference, one set for each thread."""

    def __init__(self, model: Any, fluid: Any, net: Any) -> None:
        self.data = model.createData()
        self.fluid_data = fluid.createData()
        self.net_data = net.createData()
        self.pools = batch.Pools()
        # These refer to the data's own memory, so the next computation moves them.
        self.placements = {frame.name: self.data.oMf[i] for i, frame in enumerate(model.frames)}
        self._model = model

    @cached_property
    def collisions(self) -> CollisionModel:
        """The collision bodies, made when first asked for."""
        return CollisionModel(self._model)
