"""Tables as Parquet, with the unit of each column in its field's metadata."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

from numpy.typing import NDArray

#: Columns of a table by name.
Columns = dict[str, NDArray[Any]]


def parquet_file(
    tables: Sequence[Columns],
    units: Mapping[str, str],
    repeated: Sequence[str] = (),
    compression: str = "snappy",
    **metadata: str,
) -> bytes:
    """Tables with the same columns, one below the other, as Parquet.

    Args:
        tables: Column -> values.
        units: Column -> its unit; a column without one is not here.
        repeated: Columns of numbers with few different values, for a dictionary. It
            would take most of the time for the others.
        compression: Of the columns.
        **metadata: Of the whole table.
    """
    import pyarrow
    from pyarrow import parquet

    whole = pyarrow.table({})
    if tables:
        whole = pyarrow.concat_tables([pyarrow.table(table) for table in tables])
    fields = [
        field.with_metadata({"unit": units[field.name]})
        if field.name in units
        else field
        for field in whole.schema
    ]
    texts = [field.name for field in fields if pyarrow.types.is_string(field.type)]
    in_dictionary = [field.name for field in fields if field.name in repeated]
    sink = pyarrow.BufferOutputStream()
    parquet.write_table(
        whole.cast(pyarrow.schema(fields, metadata=metadata)),
        sink,
        compression=compression,
        use_dictionary=[*texts, *in_dictionary],
    )
    return bytes(sink.getvalue())
