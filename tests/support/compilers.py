"""C compilers of this machine, and whether their sanitizers work."""

from __future__ import annotations

import shutil
import subprocess
import tempfile
from functools import cache
from pathlib import Path

UNDEFINED = "-fsanitize=undefined"
ADDRESS_AND_UNDEFINED = "-fsanitize=address,undefined"


@cache
def builds(compiler: str, flag: str) -> bool:
    """Whether a compiler makes a program that runs with a flag.

    Debian's clang comes without compiler-rt, the runtime of its sanitizers.
    """
    if shutil.which(compiler) is None:
        return False
    with tempfile.TemporaryDirectory() as folder:
        source = Path(folder) / "empty.c"
        source.write_text("int main(void) { return 0; }\n", "utf-8")
        program = Path(folder) / "empty"
        command = [compiler, flag, str(source), "-o", str(program)]
        made = subprocess.run(command, capture_output=True, check=False)
        if made.returncode:
            return False
        return subprocess.run([program], check=False).returncode == 0
