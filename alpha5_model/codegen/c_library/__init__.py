"""The arm's equations as a C99 library: a header, a source, a CMakeLists.txt and a test program.

The source needs nothing but libm, allocates nothing and keeps no state. What the test program expects comes from
Pinocchio, not from the equations that the source is generated from.
"""

from alpha5_model.codegen.c_library.files import (
    PARAMETERS,
    REALS,
    COptions,
    c_files,
)

__all__ = [
    "PARAMETERS",
    "REALS",
    "COptions",
    "c_files",
]
