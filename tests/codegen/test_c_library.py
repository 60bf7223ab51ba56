"""The C library compiles without a warning, and its program finds a wrong number."""

from __future__ import annotations

import itertools
import json
import re
import shutil
import subprocess
import sys
from pathlib import Path
from typing import Any

import own_arm_dynamics as own
import pytest
from compilers import ADDRESS_AND_UNDEFINED, builds
from dynamics_cases import TILTED

import alpha5_model as a5
from alpha5_model.cli import main
from alpha5_model.codegen.c_library import COptions, c_files

STRICT = [
    "-std=c99",
    "-pedantic",
    "-Wall",
    "-Wextra",
    "-Wdouble-promotion",
    "-Werror",
    "-O0",
]
SANITIZERS = [ADDRESS_AND_UNDEFINED, "-fno-sanitize-recover=all"]
#: Each compiler with each type, place of the parameters and check. Much is zero in air.
BUILDS = {
    "gcc, float, struct, sanitizers": (
        "gcc",
        COptions(real="float", parameters="struct"),
        SANITIZERS,
    ),
    "clang, double, struct, sanitizers": (
        "clang",
        COptions(parameters="struct", gravity=TILTED),
        SANITIZERS,
    ),
    "clang, float, folded": (
        "clang",
        COptions(fluid_density=a5.AIR, corrections=(), real="float"),
        [],
    ),
    "gcc, double, folded, own tool beside the wrist axis": (
        "gcc",
        COptions(arm=own.RECORDS[2]),
        [],
    ),
    "gcc, double, struct, own spacer and mount": (
        "gcc",
        COptions(parameters="struct", arm=own.RECORDS[9]),
        [],
    ),
}


def written(folder: Path, options: COptions) -> None:
    for name, content in c_files(options).items():
        (folder / name).write_bytes(content)


def built(folder: Path, compiler: str, *flags: str) -> subprocess.CompletedProcess[str]:
    """Compile in a folder and run the test program."""
    if shutil.which(compiler) is None:
        pytest.skip(f"there is no {compiler}")
    if ADDRESS_AND_UNDEFINED in flags and not builds(compiler, ADDRESS_AND_UNDEFINED):
        pytest.skip(f"{compiler} has no sanitizers")
    command = [
        compiler,
        *STRICT,
        *flags,
        "alpha5.c",
        "test_alpha5.c",
        "-lm",
        "-o",
        "test_alpha5",
    ]
    done = run(command, folder)
    assert done.stderr == ""
    assert done.returncode == 0
    return run(["./test_alpha5"], folder)


def run(command: list[str], folder: Path) -> subprocess.CompletedProcess[str]:
    return subprocess.run(
        command, cwd=folder, capture_output=True, text=True, check=False
    )


@pytest.mark.tools
@pytest.mark.parametrize("build", BUILDS)
def test_it_compiles_and_passes(build: str, tmp_path: Path) -> None:
    compiler, options, flags = BUILDS[build]
    written(tmp_path, options)
    done = built(tmp_path, compiler, *flags)
    assert done.stderr == ""
    assert done.returncode == 0, done.stdout
    passed, checks = map(int, re.findall(r"\d+", done.stdout))
    assert passed == checks > 1000


@pytest.mark.tools
def test_the_program_sees_a_wrong_number(tmp_path: Path) -> None:
    """It finds torques of another fluid and a wrong joint limit."""
    written(tmp_path, COptions())
    wrong = c_files(COptions(fluid_density=a5.FRESH_WATER))["alpha5.c"].decode()
    wrong = wrong.replace(str(a5.parameters().joints[1].upper), "3.3")
    (tmp_path / "alpha5.c").write_text(wrong)
    done = built(tmp_path, "gcc")
    assert done.returncode == 1
    for name in ("hydrostatic_torque", "base_wrench", "within_limits"):
        assert f"{name}, row" in done.stdout
    assert "mass_matrix" not in done.stdout


@pytest.mark.tools
def test_cmake_builds_and_tests_it(tmp_path: Path) -> None:
    if not (shutil.which("cmake") and shutil.which("ctest")):
        pytest.skip("there is no cmake")
    library = str(tmp_path / "library")
    build = str(tmp_path / "build")
    flags = f"-DCMAKE_C_FLAGS={' '.join(STRICT)}"
    assert main(["generate", "c", "--output", library]) == 0
    for command in (
        ["cmake", "-S", library, "-B", build, flags],
        ["cmake", "--build", build],
        ["ctest", "--test-dir", build],
    ):
        done = run(command, tmp_path)
        assert done.returncode == 0, done.stdout + done.stderr
    assert "100% tests passed" in done.stdout


@pytest.mark.tools
def test_the_header_says_names_shapes_and_units() -> None:
    from alpha5_model.codegen.arm_functions import SUMMARIES

    header = c_files(COptions(parameters="struct", fluid_density=1000.0))[
        "alpha5.h"
    ].decode()
    for name, summary in SUMMARIES.items():
        assert f"void alpha5_{name}(" in header
        assert summary in header
    assert " *     tau (4): joint torques [N m]" in header
    assert "Fluid: 1000 kg/m^3" in header
    assert "alpha5_real link_4_xx; /* kg m^2 */" in header
    assert ": \n" not in header
    public = re.findall(
        r"^(?:void|extern const \w+|typedef \w+) (\w+)", header, re.MULTILINE
    )
    assert all(name.startswith("alpha5_") for name in public)


@pytest.mark.tools
def test_the_source_needs_nothing_but_libm() -> None:
    from alpha5_model.codegen.arm_functions import SUMMARIES

    source = c_files()["alpha5.c"].decode()
    assert re.findall(r"#include (\S+)", source) == ['"alpha5.h"', "<math.h>"]
    called = set(re.findall(r"\b([a-z]\w*)\(", source)) - {
        f"alpha5_{name}" for name in SUMMARIES
    }
    assert called == {"sin", "cos", "sqrt", "atan2", "floor", "fabs", "fmin", "fmax"}
    single = c_files(COptions(real="float"))["alpha5.c"].decode()
    assert not re.search(r"\bdouble\b|\d\.\d+(e-?\d+)?[^\de.f]", single), (
        "no double crept in"
    )


@pytest.mark.parametrize(
    ("arguments", "said"),
    [
        (["--real", "half"], "unknown real 'half'; choose from double, float"),
        (["--parameters", "global"], "choose from folded, struct"),
        (["--gravity", "1 2"], "three numbers"),
        (["--fluid", "-1"], "at least 0"),
        (["--gripper", "jaws"], "--gripper"),
    ],
)
def test_wrong_options_end_in_one_line(
    arguments: list[str], said: str, capsys: pytest.CaptureFixture[str]
) -> None:
    assert main(["generate", "c", *arguments]) == 2
    error = capsys.readouterr().err
    assert said in error
    assert error.count("\n") == 1


def test_without_casadi_it_says_what_to_install(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str], tmp_path: Path
) -> None:
    for name in [n for n in sys.modules if n.startswith("alpha5_model.codegen")]:
        monkeypatch.delitem(sys.modules, name)
    monkeypatch.setitem(sys.modules, "casadi", None)
    assert main(["generate", "c", "--output", str(tmp_path / "c")]) == 2
    assert capsys.readouterr().err.endswith(
        "needs casadi, which is not installed: pip install 'alpha5-model[symbolic]'\n"
    )
    assert not (tmp_path / "c").exists()


#: Share by which all results are off, which is far above the bounds of the program.
OFF = {"double": 1e-7, "float": 1e-2}


@pytest.mark.tools
@pytest.mark.parametrize("real", OFF)
def test_the_program_sees_that_each_function_is_a_little_off(
    real: str, tmp_path: Path
) -> None:
    """Poses that are off are seen at every target with a solution, at edges, too."""
    from alpha5_model.codegen.arm_functions import SUMMARIES

    options = COptions(real=real, parameters="struct")
    written(tmp_path, options)
    source = (tmp_path / "alpha5.c").read_text()
    results = re.compile(r"^    ([\w*\[\]>-]+) = (.+);$", re.MULTILINE)
    wrong = results.sub(rf"    \1 = (\2) * (alpha5_real){1 + OFF[real]};", source)
    (tmp_path / "alpha5.c").write_text(wrong)
    done = built(tmp_path, "gcc")
    assert done.returncode == 1

    rows: dict[str, set[int]] = {}
    for name, row in re.findall(
        r"^([\w ]+), row (\d+): off$", done.stdout, re.MULTILINE
    ):
        rows.setdefault(name, set()).add(int(row))
    seen = {*SUMMARIES, "position", "joint position"} - {"inverse_kinematics"}
    assert rows.keys() == seen
    rows_of_targets = [*enumerate(targets(options))]
    assert rows["position"] == {i for i, one in rows_of_targets if any(one["exists"])}
    assert rows["joint position"] == {i for i, one in rows_of_targets if one["known"]}


def targets(options: COptions) -> list[dict[str, Any]]:
    """The targets of the test program."""
    program = c_files(options)["test_alpha5.c"].decode()
    (table,) = re.findall(r"targets\[\] = (.*?);", program)
    # Numbers below 0 are in brackets, and single ones end with f.
    rows = json.loads(re.sub(r"[()f]", "", table.translate({123: "[", 125: "]"})))
    names = ("position", "wrist", "exists", "within_limits", "singular", "known", "q")
    return [dict(zip(names, row, strict=True)) for row in rows]


@pytest.mark.tools
@pytest.mark.parametrize("arm", [None, own.RECORDS[2]], ids=["catalogue", "own tool"])
def test_the_targets_are_of_every_kind(arm: a5.Alpha5Parameters | None) -> None:
    joints = (arm or a5.parameters()).joints[:4]
    ends = [(joint.lower, joint.upper) for joint in joints]
    *found, out_of_reach = targets(COptions(arm=arm))
    made, on_axis, turned_too_far = found[::3], found[1::3], found[2::3]
    assert not any(out_of_reach["exists"])

    anywhere, at_limits, stretched = made[:8], made[8:16], made[16:]
    assert len(stretched) == 8
    assert all(one["known"] for one in anywhere)
    corners = {tuple(one["q"][1:]) for one in at_limits}
    assert corners == set(itertools.product(*ends[1:]))
    assert all(one["singular"] and any(one["exists"]) for one in stretched)
    for one in anywhere:
        assert all(
            low < x < high for x, (low, high) in zip(one["q"], ends, strict=True)
        )

    for one, other, turned in zip(made, on_axis, turned_too_far, strict=True):
        assert any(one["exists"])
        assert other["position"] == [0.0, 0.0, one["position"][2]]
        assert turned["position"] == one["position"]
        assert not any(turned["within_limits"])
    if arm is None:
        reached = [one for one in on_axis if any(one["exists"])]
        assert all(one["singular"] for one in reached)
        assert any(any(one["within_limits"]) for one in reached)
        assert len(on_axis) > len(reached) > len(on_axis) / 2
        assert all(any(one["exists"]) for one in turned_too_far)


#: Something wrong in the inverse kinematics -> what the program says of it.
DEFECTS = {
    **{f"q[i][{j}] += 6.283185307179586": "joint position" for j in range(4)},
    "q[i][0] = exists[i] ? q[i][0] : 0": "not a number",
    "q[i][3] = exists[i] ? q[i][3] : 0": "not a number",
    "q[i][1] += 1e-6": "position",
    **{f"exists[{i}] = !exists[{i}], i = 4": "exists" for i in range(4)},
    **{
        f"within_limits[{i}] = !within_limits[{i}], i = 4": "within_limits"
        for i in range(4)
    },
    "*singular = !*singular, i = 4": "singular",
}
WRAPPER = """
#include "alpha5.h"
typedef alpha5_real real;
void right(const real *p, real w, real q[4][4], int exists[4],
           int within_limits[4], int *singular);
void alpha5_inverse_kinematics(const real *p, real w, real q[4][4], int exists[4],
                               int within_limits[4], int *singular)
{
    right(p, w, q, exists, within_limits, singular);
    for (int i = 0; i < 4; i++) {
        %s;
    }
}
"""


@pytest.fixture(scope="module")
def objects(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The compiled program and library, whose inverse kinematics has another name."""
    if shutil.which("gcc") is None:
        pytest.skip("there is no gcc")
    folder = tmp_path_factory.mktemp("defects")
    written(folder, COptions())
    rename = "-Dalpha5_inverse_kinematics=right"
    for source, flags in (("alpha5.c", [rename]), ("test_alpha5.c", [])):
        subprocess.run(["gcc", "-O0", "-c", *flags, source], cwd=folder, check=True)
    return folder


@pytest.mark.tools
@pytest.mark.parametrize("defect", DEFECTS)
def test_the_program_sees_a_wrong_solution(defect: str, objects: Path) -> None:
    (objects / "wrapper.c").write_text(WRAPPER % defect)
    files = ["alpha5.o", "test_alpha5.o", "wrapper.c"]
    subprocess.run(
        ["gcc", "-O0", *files, "-lm", "-o", "wrong"], cwd=objects, check=True
    )
    done = run(["./wrong"], objects)
    assert done.returncode == 1
    *lines, last = done.stdout.splitlines()
    assert {line.partition(",")[0] for line in lines} >= {DEFECTS[defect]}
    passed, checks = map(int, re.findall(r"\d+", last))
    assert checks - passed == len(lines)
