"""The files of the C library for an arm."""

from __future__ import annotations

from alpha5_model.codegen.c_library.options import COptions


def c_files(options: COptions | None = None) -> dict[str, bytes]:
    """Name -> content of each file.

    Raises:
        InputError: A density below 0, or gravity that is not three finite numbers.
        UnknownNameError: No such correction.
        MissingDependencyError: CasADi is not installed.
    """
    # Late: Pinocchio and CasADi come with these.
    from alpha5_model.codegen.c_library.header_and_source import (
        header,
        programs,
        source,
    )
    from alpha5_model.codegen.c_library.self_test import test_program
    from alpha5_model.codegen.c_library.text import template
    from alpha5_model.dynamics.load import load

    chosen = options or COptions()
    arm = load(
        chosen.fluid_density,
        gravity=chosen.gravity,
        corrections=chosen.corrections,
        arm=chosen.arm,
    )
    made = programs(arm, chosen)
    texts = {
        "alpha5.h": header(arm, made, chosen),
        "alpha5.c": source(arm, made, chosen),
        "test_alpha5.c": test_program(arm, made, chosen),
        "CMakeLists.txt": template("CMakeLists.txt"),
    }
    return {name: text.encode() for name, text in texts.items()}
