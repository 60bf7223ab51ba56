"""The reductions of a study: one for each output that is not a table."""

from __future__ import annotations

from alpha5_model.studies.sweep.extremes import Extremes
from alpha5_model.studies.sweep.histograms import Histogram, Quantiles
from alpha5_model.studies.sweep.outputs import Output
from alpha5_model.studies.sweep.reduction import Reduction
from alpha5_model.studies.sweep.study import Study


def empty_reductions(study: Study) -> dict[str, Reduction]:
    """A reduction without numbers for each output that is not a table, by name."""
    return {
        name: _reduction(study, output)
        for name, output in study.outputs.items()
        if output.form != "table"
    }


def _reduction(study: Study, output: Output) -> Reduction:
    """The reduction of an output, by its form."""
    if output.form == "quantile":
        return Quantiles(output)
    if output.form == "histogram":
        return Histogram(output)
    return Extremes(study, output)
