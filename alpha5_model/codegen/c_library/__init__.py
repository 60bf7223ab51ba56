"""The arm's equations as a C99 library.

It has a header, a source, a CMakeLists.txt and a test program. The source needs nothing
but libm, allocates nothing and keeps no state. What the test program expects comes from
Pinocchio, not from the equations that the source is generated from.
"""

from alpha5_model.codegen.c_library.files import c_files
from alpha5_model.codegen.c_library.options import PARAMETERS, REALS, COptions

__all__ = [
    "PARAMETERS",
    "REALS",
    "COptions",
    "c_files",
]
