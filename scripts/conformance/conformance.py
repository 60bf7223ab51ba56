"""Run every tool on the generated files and compare it with Pinocchio: one table.

    python scripts/conformance/conformance.py [--readme docs/conformance.md]
        [--json FILE] [--states N] [--tools NAME,...]

A tool that is not installed is reported as not run; what one warns of is listed below
the table. Exit status 1 if one that ran is off.
"""

from __future__ import annotations

import argparse
import importlib.util
import json
import multiprocessing
import os
import re
import sys
import tempfile
from collections.abc import Callable, Sequence
from concurrent.futures import ProcessPoolExecutor, ThreadPoolExecutor
from dataclasses import asdict, dataclass, field
from importlib.metadata import version
from pathlib import Path

import numpy as np
import pinocchio as pin

from alpha5_model._support.writing import atomic_write
from alpha5_model.description.assets import mesh_assets
from alpha5_model.description.mjcf import MjcfOptions, mjcf_files
from alpha5_model.description.sdf import sdf_files
from alpha5_model.description.urdf import Variant, urdf
from alpha5_model.description.usd import usd_files
from alpha5_model.errors import FileFormatError, MissingFileError
from alpha5_model.numbers.fluids import SEA_WATER
from alpha5_model.numbers.parameters import parameters

if __name__ == "__main__":
    sys.path[0] = str(Path(__file__).resolve().parents[1])

from conformance import libraries, simulators, tools
from conformance.tools import Arrays, States

BEGIN, END = "<!-- conformance: begin -->", "<!-- conformance: end -->"
QUANTITIES = {
    "fk": "FK [m, 1]",
    "mass": "M [kg m²]",
    "bias": "bias [N m]",
    "buoyancy": "buoyancy [N m]",
    "trajectory": "2 s motion [rad]",
}
#: Computed numbers in files have 12 significant digits.
_DOUBLE = {
    "fk": 5e-12,
    "mass": 5e-12,
    "bias": 5e-12,
    "buoyancy": 5e-12,
    "trajectory": 1e-7,
}
#: PyBullet reports link poses in single precision.
_PYBULLET = {**_DOUBLE, "fk": 1e-6, "mass": 1e-9, "bias": 1e-9}
_SINGLE = {**dict.fromkeys(_DOUBLE, 1e-5), "mass": 2e-7}
#: SAPIEN gives a link without mass, here the tcp, 1e-6 kg and 1e-6 kg m^2.
_SAPIEN = {**_SINGLE, "mass": 2e-6}
#: A line that is of the machine, not of the file.
_MACHINE = re.compile("CUDA|GPU|performance settings")


@dataclass(frozen=True)
class Tool:
    """A tool and a file format.

    Attributes:
        name: As in the table.
        file: Format of the file it reads.
        module: What must be importable.
        package: Whose version is printed.
        compute: Function of `tools`, `libraries` or `simulators`.
        bounds: Largest error allowed of each quantity.
    """

    name: str
    file: str
    module: str
    package: str
    compute: Callable[[Path, States], Arrays]
    bounds: dict[str, float] = field(default_factory=lambda: _DOUBLE)


TOOLS = (
    Tool("MuJoCo", "MJCF", "mujoco", "mujoco", tools.mujoco_mjcf),
    Tool("MuJoCo", "URDF", "mujoco", "mujoco", tools.mujoco_urdf),
    Tool("MJX", "MJCF, capsules", "mujoco.mjx", "mujoco-mjx", tools.mjx, _SINGLE),
    Tool(
        "mujoco_warp",
        "MJCF",
        "mujoco_warp",
        "mujoco-warp",
        simulators.mujoco_warp,
        _SINGLE,
    ),
    Tool("Newton", "MJCF", "newton", "newton", simulators.newton_mjcf, _SINGLE),
    Tool("Newton", "USD", "newton", "newton", simulators.newton_usd, _SINGLE),
    Tool("UsdPhysics", "USD", "pxr", "usd-exchange", tools.usd_physics, _SINGLE),
    Tool("brax", "MJCF, no buoyancy", "brax", "brax", simulators.brax, _SINGLE),
    Tool("mink", "MJCF", "mink", "mink", libraries.mink),
    Tool("Pinocchio", "MJCF", "pinocchio", "pin", tools.pinocchio_mjcf),
    Tool("Pinocchio", "SDF", "pinocchio", "pin", tools.pinocchio_sdf),
    Tool("Drake", "MJCF", "pydrake", "drake", tools.drake_mjcf),
    Tool("Drake", "URDF", "pydrake", "drake", tools.drake_urdf),
    Tool("Drake", "SDF", "pydrake", "drake", tools.drake_sdf),
    Tool("PyBullet", "URDF", "pybullet", "pybullet", tools.pybullet_urdf, _PYBULLET),
    Tool(
        "roboticstoolbox",
        "URDF",
        "roboticstoolbox",
        "roboticstoolbox-python",
        tools.roboticstoolbox_urdf,
    ),
    Tool("DART", "URDF", "dartpy", "dartpy", simulators.dart),
    Tool("SAPIEN", "URDF, no visuals", "sapien", "sapien", simulators.sapien, _SAPIEN),
    Tool("adam", "URDF", "adam", "adam-robotics", libraries.adam),
    Tool("urdf2casadi", "URDF", "urdf2casadi", "urdf2casadi", libraries.urdf2casadi),
    Tool("frax", "URDF", "frax", "frax", libraries.frax),
    Tool(
        "pytorch_kinematics",
        "URDF",
        "pytorch_kinematics",
        "pytorch-kinematics",
        libraries.pytorch_kinematics,
        _SINGLE,
    ),
    Tool("yourdfpy", "URDF", "yourdfpy", "yourdfpy", tools.yourdfpy_urdf),
    Tool("urchin", "URDF", "urchin", "urchin", tools.urchin_urdf),
)


@dataclass(frozen=True)
class Row:
    """What came of one tool.

    Attributes:
        tool, file, version: Version is empty if the tool is not installed.
        errors: Largest error of each quantity that the tool computes.
        status: ``agrees``, ``differs``, or ``not run`` or ``failed`` with the reason.
        warnings: Lines that it printed.
    """

    tool: str
    file: str
    version: str
    errors: dict[str, float]
    status: str
    warnings: tuple[str, ...] = ()


def write_files(folder: Path) -> None:
    """The generated files that the tools read; MJX and brax want theirs simpler."""
    atomic_write(folder / "alpha5.urdf", urdf(Variant(mesh_prefix="meshes/")))
    if installed("urdf_usd_converter"):
        for name, content in usd_files().items():
            atomic_write(folder / name, content)
    mjx = MjcfOptions(collision="capsules")
    plain = MjcfOptions(collision="none", buoyancy="none", actuators="motor")
    for name, files in (
        ("meshes", mesh_assets(".obj", ".mtl")),
        ("mjcf", mjcf_files()),
        ("mjcf_mjx", mjcf_files(mjx)),
        ("mjcf_brax", mjcf_files(plain)),
        ("sdf", sdf_files()),
    ):
        for path, content in files.items():
            atomic_write(folder / name / path, content)


def random_states(count: int) -> States:
    """Configurations within the limits, and a motion that starts within them."""
    rng = np.random.default_rng(2022)
    joints = parameters().joints[:4]
    q = rng.uniform([j.lower for j in joints], [j.upper for j in joints], (count, 4))
    start = np.array([[2.0, 0.6, 0.9, 1.0], [0.3, -0.2, 0.1, 0.4]])
    return States(
        q, rng.uniform(-1.0, 1.0, (count, 4)), start, duration=2.0, steps=4000
    )


def reference(files: Path, states: States) -> Arrays:
    """The same quantities by Pinocchio, with a second model of the displaced water."""
    model = pin.buildModelFromUrdf(str(files / "alpha5.urdf"))
    fluid = pin.Model(model)
    for i in range(model.njoints):
        fluid.inertias[i] = pin.Inertia.Zero()
    for link in parameters().links:
        frame = model.frames[model.getFrameId(link.name)]
        displaced = SEA_WATER * link.volume
        point = pin.Inertia(displaced, frame.placement.act(link.cob), np.zeros((3, 3)))
        fluid.inertias[frame.parentJoint] += point
    data, fluid_data = model.createData(), fluid.createData()
    tip = model.getFrameId("tcp")

    def buoyancy(q: np.ndarray) -> np.ndarray:
        return pin.computeGeneralizedGravity(fluid, fluid_data, q).copy()

    def acceleration(q: np.ndarray, v: np.ndarray) -> np.ndarray:
        return pin.aba(model, data, q, v, buoyancy(q)).copy()

    out: dict[str, list[np.ndarray]] = {
        "fk": [],
        "mass": [],
        "bias": [],
        "buoyancy": [],
    }
    for q, v in states:
        pin.framesForwardKinematics(model, data, q)
        out["fk"].append(data.oMf[tip].homogeneous.copy())
        upper = np.triu(pin.crba(model, data, q))
        out["mass"].append(upper + np.triu(upper, 1).T)
        out["bias"].append(pin.nonLinearEffects(model, data, q, v).copy())
        out["buoyancy"].append(buoyancy(q))
    arrays = {name: np.array(rows) for name, rows in out.items()}
    return {**arrays, "trajectory": _end_of_motion(states, acceleration)}


def _end_of_motion(
    states: States, acceleration: Callable[[np.ndarray, np.ndarray], np.ndarray]
) -> np.ndarray:
    """Joint positions at the end of the free motion, by Runge and Kutta, (4,)."""
    steps = 2 * states.steps  # finer than the tools'
    h = states.duration / steps
    q, v = states.start
    for _ in range(steps):
        a1 = acceleration(q, v)
        v2 = v + h / 2 * a1
        a2 = acceleration(q + h / 2 * v, v2)
        v3 = v + h / 2 * a2
        a3 = acceleration(q + h / 2 * v2, v3)
        v4 = v + h * a3
        a4 = acceleration(q + h * v3, v4)
        q = q + h / 6 * (v + 2 * v2 + 2 * v3 + v4)
        v = v + h / 6 * (a1 + 2 * a2 + 2 * a3 + a4)
    return np.asarray(q)


def measure(tool: Tool, files: Path, states: States, expected: Arrays) -> Row:
    """Run one tool in a process of its own and compare."""
    if not installed(tool.module):
        return Row(tool.name, tool.file, "", {}, "not run")
    found = version(tool.package)
    try:
        with ProcessPoolExecutor(1, multiprocessing.get_context("spawn")) as pool:
            arrays, printed = pool.submit(
                observed, tool.compute, files, states
            ).result()
    except tools.NotBuiltError as reason:
        return Row(tool.name, tool.file, found, {}, f"not run: {reason}")
    except Exception as error:
        reason = f"failed: {type(error).__name__}: {' '.join(str(error).split())[:200]}"
        return Row(tool.name, tool.file, found, {}, reason)
    errors = {}
    for name, array in arrays.items():
        same = array.shape == expected[name].shape
        errors[name] = (
            float(np.abs(array - expected[name]).max()) if same else float("inf")
        )
    # Written so that NaN differs.
    agrees = bool(errors) and all(
        error <= tool.bounds[name] for name, error in errors.items()
    )
    verdict = "agrees" if agrees else "differs"
    return Row(tool.name, tool.file, found, errors, verdict, warned(printed))


def observed(
    compute: Callable[[Path, States], Arrays], files: Path, states: States
) -> tuple[Arrays, str]:
    """What a tool computes and what it prints, C and C++ included.

    This is for a process of its own.
    """
    with tempfile.TemporaryFile("w+", encoding="utf-8", errors="replace") as file:
        for stream in (1, 2):
            os.dup2(file.fileno(), stream)
        arrays = compute(files, states)
        sys.stdout.flush()
        sys.stderr.flush()
        file.seek(0)
        return arrays, file.read()


def warned(printed: str) -> tuple[str, ...]:
    """The warnings among printed lines, each once, without colours and folders."""
    plain = re.sub(r"\x1b\[[0-9;]*m", "", printed).replace("`", "'")
    lines = plain.replace(
        "b3Warning", "\nb3Warning"
    ).splitlines()  # PyBullet ends no line
    found = {}
    for line, following in zip(lines, [*lines[1:], ""], strict=False):
        if re.search("warning|deprecat", line, re.IGNORECASE) and not _MACHINE.search(
            line
        ):
            text = f"{line} {following}" if line.endswith(":") else line
            text = re.sub(r"(?<![\w./])(?:\.*/[\w.+-]+)+/", "", " ".join(text.split()))
            # Of the same kind on many lines of a file: once.
            text = re.sub(r"(\.xml):\d+:", r"\1:", text)
            if not text.startswith("warnings.warn("):
                found[text[:300]] = None
    return tuple(found)


def table(rows: Sequence[Row], count: int) -> str:
    """The rows as Markdown."""
    head = ["tool", "file", "version", *QUANTITIES.values(), "verdict"]
    lines = [head, ["---"] * len(head)]
    for row in rows:
        cells = [
            f"{row.errors[name]:.0e}" if name in row.errors else "–"
            for name in QUANTITIES
        ]
        lines.append([row.tool, row.file, row.version or "–", *cells, row.status])
    text = "\n".join("| " + " | ".join(line) + " |" for line in lines)
    said = [
        f"- {row.tool}, {row.file}: `{line}`" for row in rows for line in row.warnings
    ]
    warnings = "\n".join(["\n\nWhat they warned of:\n", *said]) if said else ""
    note = (
        f"Largest difference from Pinocchio {version('pin')} over {count} random "
        "states; – is what a tool does not compute by itself. "
        "Written by `make conformance`."
    )
    return f"{text}\n\n{note}{warnings}\n"


def insert(readme: Path, text: str, marks: tuple[str, str] = (BEGIN, END)) -> None:
    """Put a table between the markers of a page.

    Raises:
        MissingFileError: No such file.
        FileFormatError: The markers are not there, once each and in order.
    """
    if not readme.is_file():
        raise MissingFileError(readme, "a file with the markers of the table")
    content = readme.read_text(encoding="utf-8")
    first, last = marks
    before, begin, rest = content.partition(first)
    _, end, after = rest.partition(last)
    if not begin or not end or first in after or last in after:
        raise FileFormatError(
            readme, f"expected {first} and {last}, once each and in this order"
        )
    atomic_write(readme, f"{before}{first}\n{text}{last}{after}")


def main(arguments: Sequence[str] | None = None) -> int:
    """Run the tools, print the table; returns the exit status."""
    parser = argparse.ArgumentParser(
        description=__doc__.splitlines()[0] if __doc__ else None
    )
    names = sorted({tool.package for tool in TOOLS})
    parser.add_argument(
        "--readme", type=Path, help="insert the table between its markers"
    )
    parser.add_argument("--json", type=Path, help="write the figures too")
    parser.add_argument(
        "--states", type=int, default=1000, help="random states (default 1000)"
    )
    parser.add_argument(
        "--tools", default=",".join(names), help=f"of {', '.join(names)}"
    )
    parser.add_argument(
        "--complete", action="store_true", help="fail if a tool is not installed"
    )
    chosen = parser.parse_args(arguments)
    asked = set(chosen.tools.split(","))
    if not asked <= set(names) or chosen.states < 1:
        parser.error(f"--tools: choose from {', '.join(names)}; --states: at least 1")
    states, rows = random_states(chosen.states), []
    with tempfile.TemporaryDirectory() as folder:
        files = Path(folder)
        write_files(files)
        expected = reference(files, states)
        chosen_tools = [tool for tool in TOOLS if tool.package in asked]
        with ThreadPoolExecutor(2) as pool:  # each in a process of its own
            for row in pool.map(
                lambda tool: measure(tool, files, states, expected), chosen_tools
            ):
                print(
                    f"{row.tool} on {row.file}: {row.status}",
                    file=sys.stderr,
                    flush=True,
                )
                rows.append(row)
    text = table(rows, chosen.states)
    print(text, end="")
    if chosen.json:
        atomic_write(
            chosen.json, json.dumps([asdict(row) for row in rows], indent=2) + "\n"
        )
    if chosen.readme:
        insert(chosen.readme, text)
    return 0 if all(passed(row, chosen.complete) for row in rows) else 1


def passed(row: Row, complete: bool) -> bool:
    """Whether a row lets the run pass.

    Args:
        row: A tool that agrees passes. So does one whose package cannot read the file
            ("not run: ..."): installing it again would not help.
        complete: A tool that is not installed ("not run") does not pass.
    """
    if row.status == "not run":
        return not complete
    return row.status.startswith(("agrees", "not run: "))


def installed(module: str) -> bool:
    """Whether a module can be found."""
    try:
        return importlib.util.find_spec(module) is not None
    except ModuleNotFoundError:  # the parent package is missing
        return False


if __name__ == "__main__":
    sys.exit(main())
