"""The lengths that the bodies are drawn from [mm]."""

from __future__ import annotations

import tomllib
from dataclasses import dataclass
from pathlib import Path
from types import SimpleNamespace
from typing import Any

from alpha5_model.numbers.printed import published
from alpha5_model.numbers.tables import Published

#: Kind of its source -> name -> length, or list of lengths.
_Table = dict[str, dict[str, Any]]


@dataclass(frozen=True, eq=False)
class Dimensions:
    """Lengths of the drawn parts [mm], by the names of ``dimensions.toml``.

    Attributes:
        radius: Of every turned part.
        end_slabs: Distances from the tip of a tube's round end at which the collision
            cylinders around it become wider.
        base: Of link 0.
        shell: Of links 1 and 3.
        upper_arm: Of link 2.
        wrist: Of link 4.
        finger: Of both fingers.
        jaws: Supplementary lengths of the jaws.
    """

    radius: float
    end_slabs: tuple[float, ...]
    base: SimpleNamespace
    shell: SimpleNamespace
    upper_arm: SimpleNamespace
    wrist: SimpleNamespace
    finger: SimpleNamespace
    jaws: SimpleNamespace


def drawn_dimensions() -> Dimensions:
    """The dimensions of the published arm."""
    return dimensions_of(published())


def dimensions_of(printed: Published) -> Dimensions:
    """The dimensions in ``dimensions.toml``, and those that the document prints."""
    path = Path(__file__).with_name("dimensions.toml")
    table: dict[str, _Table] = tomllib.loads(path.read_text(encoding="utf-8"))
    first_row: Any = printed.table_1.rows[0]
    table["shell"]["printed"] = {
        "axes_apart": first_row.a.value,
        "shoulder": first_row.d.value,
    }
    table["upper_arm"]["printed"] = {
        "reach": printed.elbow.adjacent.value,
        "drop": printed.elbow.opposite.value,
    }
    jaws = {
        name: float(jaw.quantity.value)
        for name, jaw in printed.supplementary.jaws.items()
    }
    turned = _by_name(table["turned"])
    return Dimensions(
        radius=turned.radius,
        end_slabs=turned.end_slabs,
        base=_by_name(table["base"]),
        shell=_by_name(table["shell"]),
        upper_arm=_by_name(table["upper_arm"]),
        wrist=_by_name(table["wrist"]),
        finger=_by_name(table["finger"]),
        jaws=SimpleNamespace(**jaws),
    )


def _by_name(table: _Table) -> SimpleNamespace:
    """The dimensions of one part as attributes."""
    part = SimpleNamespace()
    for lengths in table.values():
        for name, value in lengths.items():
            is_list = isinstance(value, list)
            setattr(part, name, tuple(value) if is_list else float(value))
    return part
