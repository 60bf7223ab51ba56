"""Runs the command line on many inputs, each in a child, and reports on each child.

    python hostile_runner.py CASES.json RESULTS.json

A case has ``args`` and a working directory ``folder``. The runner loads all modules
once and forks each child from there. A child's processor time is then the input's own.
"""

from __future__ import annotations

import contextlib
import io
import json
import os
import resource
import sys
import time
import traceback
from pathlib import Path
from typing import Any

import rosbags.rosbag1
import rosbags.rosbag2
import rosbags.typesys
import watch

import alpha5_model as a5
import xacro
from alpha5_model import cli

#: A child is ended after so much processor time, or a longer wait [s].
CPU_LIMIT, PATIENCE = 60, 200


def warm() -> None:
    """Load what commands load when they first need it."""
    rosbags.typesys.get_typestore(rosbags.typesys.Stores.LATEST)
    rosbags.typesys.get_typestore(rosbags.typesys.Stores.ROS1_NOETIC)
    assert all((xacro, rosbags.rosbag1, rosbags.rosbag2))
    with (
        contextlib.redirect_stdout(io.StringIO()),
        contextlib.redirect_stderr(io.StringIO()),
    ):
        cli.main(["compare", str(a5.URDF_PATH), "--samples", "3"])
        cli.main(["check", "--urdf", str(a5.URDF_PATH)])
        cli.main(["dh", "--urdf", str(a5.URDF_PATH)])
        cli.main(["trajectory", "no_such_file.csv"])
        cli.main(["sweep", "no_such_file.toml", "--output", "no_such_folder"])
        cli.main(["torque", "--q", "1", "1", "1", "1"])


def child(case: dict[str, Any], report: Path) -> int:
    """The exit status of the entry point of ``alpha5`` with these words."""
    os.chdir(case["folder"])
    for descriptor, name in ((1, "out"), (2, "err")):
        file = os.open(f"{report}.{name}", os.O_WRONLY | os.O_CREAT | os.O_TRUNC)
        os.dup2(file, descriptor)
    sys.stdout = os.fdopen(1, "w", encoding="utf-8", closefd=False)
    sys.stderr = os.fdopen(
        2, "w", encoding="utf-8", errors="backslashreplace", closefd=False
    )
    resource.setrlimit(resource.RLIMIT_CPU, (CPU_LIMIT, CPU_LIMIT))
    sys.argv = ["alpha5", *case["args"]]
    status = 0
    with watch.watching() as misdeeds:
        try:
            cli.run()
        except SystemExit as end:
            status = end.code if isinstance(end.code, int) else 1
        except BaseException:
            traceback.print_exc()
            status = 1
    sys.stdout.flush()
    sys.stderr.flush()
    Path(f"{report}.misdeeds").write_text(json.dumps(misdeeds), "utf-8")
    return status


def tried(case: dict[str, Any], report: Path) -> dict[str, Any]:
    """Status (negative: a signal), output, misdeeds, processor time [s], memory [B]."""
    before = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
    pid = os.fork()
    if pid == 0:
        status = 70
        try:
            status = child(case, report)
        finally:
            os._exit(status)
    begun = time.monotonic()
    ended, state, usage = os.wait4(pid, os.WNOHANG)
    while not ended:
        time.sleep(0.005)
        if time.monotonic() - begun > PATIENCE:
            os.kill(pid, 9)
        ended, state, usage = os.wait4(pid, os.WNOHANG)
    misdeeds = Path(f"{report}.misdeeds")
    return {
        "status": os.waitstatus_to_exitcode(state),
        "out": Path(f"{report}.out").read_text("utf-8", "replace"),
        "err": Path(f"{report}.err").read_text("utf-8", "replace"),
        "misdeeds": json.loads(misdeeds.read_text("utf-8"))
        if misdeeds.exists()
        else ["no report"],
        "seconds": usage.ru_utime + usage.ru_stime,
        "memory": 1024 * (usage.ru_maxrss - before),
    }


def main() -> None:
    """Run; see the top of this file."""
    cases, results = (Path(word) for word in sys.argv[1:])
    warm()
    found = {
        name: tried(case, results.with_name(f"report-{k}"))
        for k, (name, case) in enumerate(json.loads(cases.read_text("utf-8")).items())
    }
    results.write_text(json.dumps(found), encoding="utf-8")


if __name__ == "__main__":
    main()
