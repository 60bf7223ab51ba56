"""The units of the columns of a study's tables."""

from __future__ import annotations

from alpha5_model.studies.sweep.outputs import Output
from alpha5_model.studies.sweep.schema import CASE_AXES, STATE_AXES
from alpha5_model.studies.sweep.study import Study


def units_of_axes(study: Study) -> dict[str, str]:
    """Axis of a study that has a unit -> its SI unit."""
    every_unit = {**STATE_AXES, **CASE_AXES}
    axes = [*study.cases, *study.states, *study.drawn]
    return {name: every_unit[name] for name in axes if every_unit.get(name)}


def units_of_rows(study: Study) -> dict[str, str]:
    """Column of the rows of a study -> its unit."""
    units = units_of_axes(study)
    if "recording" in study.cases:
        units["time"] = "s"
    for output in study.outputs.values():
        for column in output.columns:
            units[f"{output.quantity}.{column}"] = output.unit
    return units


def units_of_result(study: Study, output: Output) -> dict[str, str]:
    """Column of the table of an output -> its unit."""
    if output.form == "histogram":  # the other columns are counts
        return {"low": output.unit, "high": output.unit}
    if output.form == "quantile":
        ends = ("low", "high")
        columns = [f"{column}_{end}" for column in output.columns for end in ends]
        return dict.fromkeys(columns, output.unit)
    return {**units_of_axes(study), **dict.fromkeys(output.columns, output.unit)}
