"""Where the numbers of a generated file come from."""

from __future__ import annotations

from alpha5_model import __version__
from alpha5_model.numbers.parameters import Alpha5Parameters, is_catalogue
from alpha5_model.numbers.printed import published


def provenance(parameters: Alpha5Parameters) -> dict[str, str]:
    """Document, package and corrections that the parameters come from."""
    source = published().table_2.source
    edition = f"version {source.version}, {source.date}"
    document = f"{source.publisher}, {source.document}, {edition}"
    if not is_catalogue(parameters):
        document += f"; changed for the arm {parameters.name}"
    return {
        "document": document,
        "package": f"alpha5_model {__version__}",
        "corrections": ", ".join(parameters.corrections) or "none",
    }
