"""Run ROS, Gazebo and other tools on the package, and compare them with Pinocchio.

    scripts/conformance/real_tools.sh PYTHON [--page docs/conformance.md]
        [--picture FILE]

`real_tools.sh` installs from Debian what is missing. A tool that is not there is
reported as not run and why. Exit status 1 if one that ran is off.
"""

from __future__ import annotations

import argparse
import shutil
import subprocess
import sys
import tempfile
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path

if __name__ == "__main__":
    sys.path[0] = str(Path(__file__).resolve().parents[1])

from conformance import gazebo_tools, linters, ros_tools, usd_tools
from conformance.conformance import insert
from conformance.ros_tools import Result, Workspace

MARKS = "<!-- real tools: begin -->", "<!-- real tools: end -->"


@dataclass(frozen=True)
class Check:
    """A tool and what is asked of it.

    Attributes:
        tool: As in the table.
        package: Debian's, whose version is printed; empty for Python's, which says it
            itself.
        needs: Programs, by name or path, without which it is not run.
        compared: In words.
        run: What does it.
        bound: Largest difference allowed.
    """

    tool: str
    package: str
    needs: tuple[str, ...]
    compared: str
    run: Callable[[Workspace], Result]
    bound: float = 0.0


_ROS = ("roscore", ros_tools.PUBLISHER, "/usr/bin/python3")
CHECKS = (
    Check(
        "colcon, ament_cmake",
        "colcon",
        ("/usr/bin/colcon", "/usr/share/ament_cmake/cmake/ament_cmakeConfig.cmake"),
        "the package builds; every mesh URI of the installed URDFs names "
        "an installed file",
        ros_tools.build,
    ),
    Check(
        "check_urdf",
        "liburdfdom-tools",
        ("/usr/bin/check_urdf",),
        "both URDFs parse; links, each under its parent, are Pinocchio's",
        ros_tools.parse,
    ),
    Check(
        "robot_state_publisher, tf (ROS 1)",
        "ros-robot-state-publisher",
        _ROS,
        "poses of tcp and both fingers, 100 states [m, 1]; an empty log",
        ros_tools.publish,
        1e-13,
    ),
    Check(
        "RViz (ROS 1)",
        "rviz",
        (*_ROS, "/usr/bin/colcon", "rviz", "Xvfb"),
        "picture of the installed URDF at home, on a virtual screen",
        ros_tools.look,
    ),
    Check(
        "libsdformat",
        "libsdformat12-12",
        ("ign",),
        "model and world in SDF 1.9, jaws locked and moving, are valid; "
        "a broken one is not",
        gazebo_tools.validate,
    ),
    Check(
        "ignition-physics, DART",
        "libignition-physics5-dartsim-plugin5",
        ("g++", "pkg-config", gazebo_tools.PLUGIN),
        "accelerations over one step [rad/s²] and pose of link_4 [m, 1], 100 states",
        gazebo_tools.step,
        1e-9,
    ),
    Check(
        "libsdformat of Drake",
        "",
        (),
        "model in SDF 1.11 with `<mimic>` and `<fluid_added_mass>` is taken; "
        "one that follows no joint is not",
        gazebo_tools.follow,
    ),
    Check(
        "placo",
        "",
        (),
        "FK of the tcp [m, 1], M [kg m²] and gravity torque [N m], 100 states",
        gazebo_tools.placo,
        1e-12,
    ),
    Check(
        "mujoco-usd-converter",
        "",
        (),
        "the MuJoCo model in USD: FK of the tcp [m, 1], M [kg m²], gravity torque "
        "[N m], 100 states; mass; water",
        usd_tools.mujoco_converter,
        1e-6,
    ),
    Check(
        "simcheck",
        "",
        (),
        "URDF and MuJoCo model: errors and warnings are those that are explained",
        linters.simcheck,
    ),
    Check("truerig", "", (), "the same", linters.truerig),
)


def row(check: Check, work: Workspace) -> tuple[str, ...]:
    """Run a check: tool, version, what is compared, what came out, verdict."""
    words = check.tool, _version(check.package), check.compared
    missing = [
        name
        for name in check.needs
        if shutil.which(name) is None and not Path(name).exists()
    ]
    if missing:
        return *words, f"{', '.join(missing)} not there", "not run"
    try:
        result = check.run(work)
    except ros_tools.NotThereError as absence:
        return *words, str(absence), "not run"
    except Exception as error:
        said = getattr(error, "stderr", None) or error
        return (
            *words,
            f"{type(error).__name__}: {' '.join(str(said).split())[-300:]}",
            "failed",
        )
    # Written so that NaN differs.
    agrees = result.difference <= check.bound and not result.complaints
    found = "; ".join((result.text, *result.complaints, *result.warnings))
    return (
        words[0],
        result.version or words[1],
        words[2],
        found,
        "agrees" if agrees else "differs",
    )


def _version(package: str) -> str:
    if not package or shutil.which("dpkg-query") is None:
        return "–"
    query = ["dpkg-query", "-W", "-f", "${Version}", package]
    return (
        subprocess.run(query, capture_output=True, text=True, check=False).stdout or "–"
    )


def table(rows: Sequence[tuple[str, ...]]) -> str:
    """The rows as Markdown."""
    head = (
        "tool",
        "version",
        "what was compared with Pinocchio or looked at",
        "found",
        "verdict",
    )
    lines = [head, ("---",) * len(head), *rows]
    return "\n".join("| " + " | ".join(line) + " |" for line in lines) + "\n"


def main(arguments: Sequence[str] | None = None) -> int:
    """Run the checks, print the table; returns the exit status."""
    parser = argparse.ArgumentParser(
        description=__doc__.splitlines()[0] if __doc__ else None
    )
    parser.add_argument(
        "--page", type=Path, help="insert the table between its markers"
    )
    parser.add_argument("--picture", type=Path, help="keep RViz's picture")
    parser.add_argument(
        "--complete", action="store_true", help="fail if a tool is not there"
    )
    chosen = parser.parse_args(arguments)
    rows = []
    with tempfile.TemporaryDirectory() as folder:
        work = Workspace(Path(folder))
        for check in CHECKS:
            rows.append(row(check, work))
            print(f"{check.tool}: {rows[-1][-1]}", file=sys.stderr, flush=True)
        if chosen.picture and work.picture.is_file():
            shutil.copy(work.picture, chosen.picture)
    text = table(rows)
    print(text, end="")
    if chosen.page:
        insert(chosen.page, text, MARKS)
    accepted = ("agrees",) if chosen.complete else ("agrees", "not run")
    return 0 if all(verdict in accepted for *_, verdict in rows) else 1


if __name__ == "__main__":
    sys.exit(main())
