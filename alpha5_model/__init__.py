"""The Reach Alpha 5 arm: URDF, dynamics under water and closed-form inverse kinematics.

Generated from the manufacturer's printed tables. ``import alpha5_model`` loads no other
package; Pinocchio, xacro, meshcat and matplotlib are imported when something that needs
them is called.
"""

from __future__ import annotations

from typing import Any

from alpha5_model.errors import MissingDependencyError

__version__ = "2.0.0"


def _public_names() -> dict[str, tuple[str, str]]:
    """Public name -> its module, and its name there; ``__init__.pyi`` has them."""
    stub = __loader__.get_data(f"{__path__[0]}/__init__.pyi").decode()
    stub = stub.replace("\r", "")  # of a checkout on Windows
    lines = stub.replace("(\n", "").replace(",\n)", "").splitlines()
    words = [line.split() for line in lines if line.startswith("from ")]
    return {public: (module, name) for _, module, _, name, _, public in words}


_PUBLIC = _public_names()
__all__ = sorted([*_PUBLIC, "__version__"])


def __getattr__(name: str) -> Any:
    """Import a public name when it is first used.

    Raises:
        MissingDependencyError: It needs a package that is not installed.
    """
    if name not in _PUBLIC:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    module, name_there = _PUBLIC[name]
    try:
        if module == __name__:
            __import__(f"{module}.{name_there}")
            return globals()[name]
        value = getattr(__import__(module, fromlist=[name_there]), name_there)
    except MissingDependencyError:
        raise
    except ModuleNotFoundError as error:
        remedy = "python -m pip install alpha5-model, without --no-deps"
        raise MissingDependencyError(
            str(error.name), f"alpha5_model.{name}", remedy
        ) from None
    globals()[name] = value
    return value


def __dir__() -> list[str]:
    return __all__
