"""The compiled kernels, for tests that concern them alone."""

from __future__ import annotations

import importlib
import os
from types import ModuleType

import pytest

NAME = "alpha5_model.kernels._compiled"


def compiled_kernels() -> ModuleType:
    """The compiled module; without it the test, or the file, is skipped.

    So it is where ``ALPHA5_KERNELS`` asks for NumPy's kernels. Elsewhere a missing
    module is an error if ``ALPHA5_REQUIRE_KERNELS`` is 1.
    """
    if os.environ.get("ALPHA5_KERNELS") != "numpy":
        try:
            return importlib.import_module(NAME)
        except ImportError:
            if os.environ.get("ALPHA5_REQUIRE_KERNELS") == "1":
                raise
    pytest.skip("the kernels are not compiled here", allow_module_level=True)
