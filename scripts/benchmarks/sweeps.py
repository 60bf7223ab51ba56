"""A row of a study: its extremes, quantiles, histogram, or the row itself in a file."""

from __future__ import annotations

import tempfile
from functools import partial
from pathlib import Path

from benchmarks.timing import Row, measure

from alpha5_model.studies.sweep.chunks import Chunks, chunks_of, compute
from alpha5_model.studies.sweep.study import read_study

ROWS = 200_000
#: Form of an output -> its keys in a study, and the time for a row that is wanted [ns],
#: on one core without other load.
FORMS = {
    "peak": ("", 80),
    "quantile": ("levels = [0.5]", 130),
    "histogram": ("range = [-1, 1]\nbins = 100", 130),
    "table": ("", 250),
}
_STUDY = f"""
samples = {ROWS}
[axes]
axis_e_pos = 0.1
axis_d_pos = {{random = [0, 3]}}
axis_c_pos = {{random = [0, 3]}}
axis_b_pos = {{random = [-3, 3]}}
axis_d_vel = {{random = [-0.5, 0.5]}}
[outputs.torque]
quantity = "torque"
"""


def missing() -> list[str]:
    """Peers that are not installed."""
    return []


def rows() -> list[Row]:
    """One work: random states, their torques, and what is kept of them."""
    with tempfile.TemporaryDirectory() as folder:
        studies = {form: _chunks(Path(folder), form) for form in FORMS}
        functions = {
            form: partial(compute, chunks, 0) for form, chunks in studies.items()
        }
        seconds = measure(functions, per_call=ROWS, rounds=5)
    return [
        Row(
            work="a row of a sweep",
            candidate=form,
            seconds=seconds[form],
            setup=f"torques of random states; wanted: {wanted} ns",
        )
        for form, (_, wanted) in FORMS.items()
    ]


def _chunks(folder: Path, form: str) -> Chunks:
    """A study that keeps torques in one form."""
    keys, _ = FORMS[form]
    study = folder / f"{form}.toml"
    study.write_text(f'{_STUDY}as = "{form}"\n{keys}\n', encoding="utf-8")
    return chunks_of(read_study(study), ROWS)
