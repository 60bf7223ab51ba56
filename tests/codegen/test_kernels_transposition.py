"""Rows of a batch become columns and rows again; no memory beyond them is touched."""

from __future__ import annotations

import subprocess
from pathlib import Path

import pytest
from compilers import ADDRESS_AND_UNDEFINED, builds

ROOT = Path(__file__).resolve().parents[2]
pytestmark = pytest.mark.tools


@pytest.mark.parametrize("compiler", ["gcc", "clang"])
def test_rows_to_columns_and_back(compiler: str, tmp_path: Path) -> None:
    if not builds(compiler, ADDRESS_AND_UNDEFINED):
        pytest.skip(f"{compiler} has no sanitizers")
    (tmp_path / "nothing.h").touch()
    program = tmp_path / "transposition"
    subprocess.run(
        [
            compiler,
            "-O1",
            "-Wall",
            "-Wextra",
            "-Werror",
            "-Wno-psabi",
            "-Wno-unused-function",
            ADDRESS_AND_UNDEFINED,
            "-fno-sanitize-recover=all",
            f"-I{tmp_path}",
            f"-I{ROOT / 'alpha5_model' / 'codegen' / 'kernels'}",
            str(ROOT / "tests" / "support" / "transposition.c"),
            "-lm",
            "-o",
            str(program),
        ],
        check=True,
    )
    done = subprocess.run([program], capture_output=True, text=True, check=False)
    assert (done.returncode, done.stderr) == (0, "")
