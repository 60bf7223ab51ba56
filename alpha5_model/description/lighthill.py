"""The water of each link as lighthill reads it, a library for Isaac Lab and Newton.

lighthill [lighthill]_ applies buoyancy, added mass and drag to the links of an
articulation. Its YAML file has the links in the order of the simulator's bodies; all
numbers are about the centre of mass, where the simulator applies its forces.

.. [lighthill] github.com/jeffrichley/lighthill, ``src/lighthill/config.py``,
   ``forces.py`` and ``apply_isaac.py``, 2026.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from alpha5_model._support.checks import choice
from alpha5_model.description.assets import template
from alpha5_model.description.water_table import WaterOptions, water_table
from alpha5_model.numbers.hydrodynamics import LEVELS


@dataclass(frozen=True)
class LighthillOptions(WaterOptions):
    """Options of lighthill's file: those of the table, and the level of the estimates.

    Attributes:
        level: ``low``, ``nominal`` or ``high`` end of added mass and drag.
    """

    level: str = "nominal"

    def __post_init__(self) -> None:
        super().__post_init__()
        choice("level", self.level, LEVELS)


def lighthill_files(options: LighthillOptions | None = None) -> dict[str, bytes]:
    """``lighthill.yaml``: its list ``links``, one row for each link with a volume.

    Raises:
        Alpha5Error: See `LighthillOptions`.
    """
    import yaml

    chosen = options or LighthillOptions()
    table = water_table(chosen)
    content = {
        "density": table["fluid_density"],
        "links": [
            _link(name, row, chosen.level) for name, row in table["links"].items()
        ],
    }
    text = yaml.safe_dump(content, sort_keys=False, default_flow_style=None, width=110)
    words = {**table, **table["provenance"], "level": chosen.level}
    return {
        "lighthill.yaml": (
            template("lighthill_head.yaml").format(**words) + text
        ).encode()
    }


def _link(name: str, row: dict[str, Any], level: str) -> dict[str, Any]:
    """One entry; a link that the water does not reach has zeros."""
    nothing = np.zeros((6, 6))
    added_mass = row["added_mass"].get(level, nothing)
    drag = row["quadratic_drag"].get(level, nothing)
    return {
        "name": name,
        "volume": row["volume"],
        "center_of_buoyancy": row["center_of_buoyancy_from_com"],
        "added_mass": {"kind": "matrix", "matrix": np.ravel(added_mass).tolist()},
        "linear_damping": [0.0] * 6,
        "quadratic_damping": np.ravel(drag).tolist(),
    }
