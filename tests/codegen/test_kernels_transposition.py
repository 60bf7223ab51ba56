"""Rows of a batch become columns and rows again; no memory beyond them is touched."""

from __future__ import annotations

import subprocess
from pathlib import Path

import pytest
from compilers import ADDRESS_AND_UNDEFINED, builds

ROOT = Path(__file__).resolve().parents[2]
COMPILERS = [name for name in ("gcc", "clang") if builds(name, ADDRESS_AND_UNDEFINED)]
pytestmark = pytest.mark.skipif(
    not COMPILERS, reason="no C compiler with sanitizers here"
)


@pytest.mark.slow
@pytest.mark.parametrize("compiler", COMPILERS)
def test_rows_to_columns_and_back(compiler: str, tmp_path: Path) -> None:
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
