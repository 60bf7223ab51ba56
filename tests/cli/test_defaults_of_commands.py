"""Commands without options do what the functions do that they call."""

from __future__ import annotations

import inspect
import json
import re
from dataclasses import replace
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from PIL import Image
from urdf_edits import OWN, with_mass

import alpha5_model as a5
from alpha5_model.cli import (
    compare,
    demo,
    generate,
    main,
    sweep,
    values,
    view,
    workspace,
)
from alpha5_model.cli.torque_record import Motors, State, torque_record
from alpha5_model.cli.torque_text import torque_lines
from alpha5_model.errors import InputError
from alpha5_model.proofs.comparison.records import Finding

Capture = pytest.CaptureFixture[str]
POSE = ["--q", "3.1", "1.2", "1.8", "0"]


def answer(capsys: Capture, *words: str) -> Any:
    assert main([*words, "--json"]) == 0
    return json.loads(capsys.readouterr().out)


@pytest.fixture
def other(tmp_path: Path) -> Path:
    file = tmp_path / "other.urdf"
    file.write_text(with_mass(OWN, "0.5"), "utf-8")
    return file


# --- generate -------------------------------------------------------------------------


@pytest.mark.slow
@pytest.mark.parametrize("form", ["mjcf", "sdf", "c", "usd", "water", "lighthill"])
def test_a_format_without_options_is_the_library_without(
    form: str, capsys: Capture
) -> None:
    made = generate._FORMATS[form]
    assert main(["generate", "--format", form]) == 0
    expected = made.files(made.options())[made.main_file]
    assert capsys.readouterr().out == expected.decode()


def test_an_option_beside_a_check_is_named_by_its_long_name(capsys: Capture) -> None:
    assert main(["generate", "--check", "-o", "x.urdf"]) == 2
    assert "--output: expected nothing beside --check" in capsys.readouterr().err


def test_an_update_names_what_it_wrote(
    monkeypatch: pytest.MonkeyPatch, capsys: Capture
) -> None:
    monkeypatch.setattr(generate.committed, "update", lambda: [Path("one.urdf")])
    monkeypatch.setattr(generate.committed, "not_generated", lambda: ["no meshes"])
    assert main(["generate", "--update"]) == 0
    assert capsys.readouterr().out == "wrote one.urdf\nno meshes\n"


def test_a_check_counts_files_and_shows_what_differs(
    monkeypatch: pytest.MonkeyPatch, capsys: Capture
) -> None:
    stale = [SimpleNamespace(diff="-a\n+b\n")]
    three = {Path(name): b"" for name in "abc"}
    monkeypatch.setattr(generate.committed, "generated_files", lambda: three)
    monkeypatch.setattr(generate.committed, "not_generated", list)
    for found, status, text in (
        (stale, 1, "-a\n+b\n2 of 3 generated files are fresh\n"),
        ([], 0, "3 of 3 generated files are fresh\n"),
    ):
        monkeypatch.setattr(
            generate.committed,
            "stale_files",
            lambda fresh, found=found: found,
        )
        assert main(["generate", "--check"]) == status
        assert capsys.readouterr().out == text


# --- pictures -------------------------------------------------------------------------


def test_a_picture_of_a_diagram_is_fit_for_print(
    tmp_path: Path, capsys: Capture
) -> None:
    """A hundred dots per inch or more, as the file itself says, and all of the page."""
    path = tmp_path / "polar.png"
    words = ["torque", *POSE, "--current", "0 1 0", "--plot", str(path)]
    assert main(words) == 0
    with Image.open(path) as picture:
        across, up = picture.info["dpi"]
        assert across == up > 100
        assert min(picture.size) > 4 * across


# --- texts of options -----------------------------------------------------------------


@pytest.mark.parametrize(
    ("counts", "unit", "expected"),
    [
        ((1,), "m", "one number (m)"),
        ((2,), "rad", "two numbers (rad)"),
        ((3,), "m/s", "three numbers (m/s)"),
        ((4, 5), "rad", "four numbers or five numbers (rad)"),
        ((9,), "m", "9 numbers (m)"),
    ],
)
def test_what_is_expected_is_said_in_words(
    counts: tuple[int, ...], unit: str, expected: str
) -> None:
    with pytest.raises(InputError, match=re.escape(f"expected {expected}, got 'x'")):
        values.numbers("name", "x", counts, unit)
    with pytest.raises(InputError, match=re.escape(f"expected {expected}, got ")):
        values.numbers("name", " ".join("1" * 7), counts, unit)


@pytest.mark.parametrize(("text", "density"), [("0", 0.0), ("0.5", 0.5), ("air", 0.0)])
def test_a_fluid_may_be_thin(text: str, density: float) -> None:
    assert values.fluid_density(text) == density
    with pytest.raises(InputError, match="fluid"):
        values.fluid_density("-0.5")


@pytest.mark.parametrize(
    ("parts", "sign", "found"),
    [
        (["a=1", "b=2"], "=", {"a": "1", "b": "2"}),
        ([" a := 1 ", "", " "], ":=", {"a": "1"}),
        (["a=b=c"], "=", {"a": "b=c"}),
    ],
)
def test_pairs_are_names_and_values(
    parts: list[str], sign: str, found: dict[str, str]
) -> None:
    assert values.pairs("package", parts, sign) == found


@pytest.mark.parametrize("parts", [["a"], ["=1"], ["a="], ["a=1", "a=2"]])
def test_pairs_that_are_none_are_refused(parts: list[str]) -> None:
    with pytest.raises(InputError, match="NAME=VALUE with each name once"):
        values.pairs("package", parts, "=")
    # Only an argument of xacro may be empty.
    if parts == ["a="]:
        assert values.pairs("arg", parts, "=") == {"a": ""}


def test_the_help_has_no_options_of_a_shell(capsys: Capture) -> None:
    assert main(["--help"]) == 0
    text = capsys.readouterr().out
    assert "--version" in text
    assert "completion" not in text


def test_a_report_for_ci_ends_with_one_line_end(other: Path, capsys: Capture) -> None:
    assert main(["compare", str(other), "--samples", "1", "--format", "junit"]) == 1
    text = capsys.readouterr().out
    assert text.startswith("<?xml")
    assert text == text.rstrip() + "\n"


# --- defaults -------------------------------------------------------------------------


def test_a_sweep_uses_this_process_unless_it_is_given_workers(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: Capture
) -> None:
    asked = []

    def run_study(*paths: Path, workers: int, **options: Any) -> None:
        asked.append(workers)
        raise InputError("workers", workers, "no work in this test")

    monkeypatch.setattr(sweep, "run_study", run_study)
    words = ["sweep", str(tmp_path / "study.toml"), "-o", str(tmp_path / "out")]
    assert main(words) == 2
    assert main([*words, "--workers", "0"]) == 2
    assert main([*words, "--workers", "-1"]) == 2
    assert asked == [0, 0]
    assert "no work in this test" in capsys.readouterr().err


@pytest.mark.parametrize("count", [5, 6])
def test_up_to_five_values_of_a_study_are_all(count: int) -> None:
    values_of_joint = np.arange(float(count))
    values_of_joint[1] = np.inf
    columns = {"axis_e": values_of_joint, "axis_e_row": np.arange(count)}
    record: dict[str, Any] = {
        "rows": 7,
        "units": {"a": "N m"},
        "outputs": {"a": columns},
        "failures": {},
        "repaired": [],
        "foreign": [],
    }
    title = "\na [N m]" + (": the first 5 of 6" if count > 5 else "")
    assert list(sweep._text(record)) == ["7 rows", title, "  axis_e  0  -  2  3  4"]


def test_the_workspace_tries_as_many_points_as_the_library(
    monkeypatch: pytest.MonkeyPatch, capsys: Capture
) -> None:
    asked = []

    def sampled_share(free: Any, samples: int, **more: Any) -> None:
        asked.append(samples)
        raise InputError("samples", samples, "no work in this test")

    default = inspect.signature(workspace.space.sampled_share).parameters["samples"]
    monkeypatch.setattr(workspace.space, "sampled_share", sampled_share)
    assert main(["workspace", "--self-collision"]) == 2
    assert asked == [default.default]
    assert capsys.readouterr().out == ""


@pytest.mark.parametrize(
    ("pose", "q"),
    [
        ("reach", a5.named_pose("reach").tolist()),
        ("180 90 180 90 deg", a5.named_pose("reach").tolist()),
        ("180 90 180 90 8mm deg", [*a5.named_pose("reach").tolist(), 0.008]),
        ("3.1,1.2,1.8,0", [3.1, 1.2, 1.8, 0.0]),
    ],
)
def test_a_pose_may_be_in_degrees(pose: str, q: list[float]) -> None:
    found = view._position(a5.load(gripper="jaws"), pose)
    np.testing.assert_allclose(found[: len(q)], q, atol=1e-12)
    assert found[4] == (0.008 if len(q) > 4 else a5.parameters().joints[4].lower)


@pytest.mark.parametrize("serve", [True, False])
def test_the_live_viewer_takes_a_free_port_and_opens_a_browser(
    serve: bool, monkeypatch: pytest.MonkeyPatch
) -> None:
    served: list[tuple[int, bool]] = []

    def stay(arm: Any, shown: Any, port: int, open_browser: bool) -> None:
        served.append((port, open_browser))

    monkeypatch.setattr(view, "_serve", stay)
    monkeypatch.setenv("DISPLAY", ":0")
    assert main(["view", "--pose", "home", *["--serve"] * serve]) == 0
    assert served == [(0, not serve)]


# --- findings -------------------------------------------------------------------------


@pytest.mark.parametrize("serious", [True, False])
@pytest.mark.parametrize("instead", ["", "write this"])
def test_only_remarks_that_say_the_same_are_counted(
    serious: bool, instead: str
) -> None:
    """What is serious, or can be mended, is told for each place."""
    one = Finding(
        where="link_1",
        text="has no mesh",
        serious=serious,
        instead=instead,
        cost=0.0,
        id="file",
    )
    others = [replace(one, where=f"link_{k}") for k in (2, 3)]
    last = replace(one, text="has another mesh")
    found = compare._alike([one, *others, last, one])
    remark = not serious and not instead
    if remark:
        assert found == [(one, 2), (last, 0), (one, 0)]
    else:
        assert found == [(each, 0) for each in (one, *others, last, one)]
    costly = replace(one, cost=0.12345)
    assert compare._alike([one, costly]) == [(one, 0), (costly, 0)]


def test_a_picture_without_a_motion_is_framed_as_it_stands(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: Capture
) -> None:
    also_seen: list[Any] = []

    def framed(shown: Any, size: Any, also: Any) -> Any:
        also_seen.extend([size, also])
        return shown

    monkeypatch.setattr(view, "framed", framed)
    monkeypatch.setattr(view, "picture_png", lambda shown, size: b"")
    words = ["view", "--image", str(tmp_path / "arm.png"), "--size", "320X200"]
    assert main(words) == 0
    assert also_seen == [(320, 200), []]


def test_the_page_of_the_demo_opens_the_jaws_within_their_limits() -> None:
    scene = demo._scene(a5.named_pose("reach"))
    assert scene.motion is not None
    rod = np.array(scene.motion.q)[:, 4]
    joint = a5.parameters().joints[4]
    assert rod.min() == joint.lower
    assert joint.lower < rod.max() <= joint.upper


def test_the_assumptions_have_no_rounding_of_gravity() -> None:
    """Nor a negative zero: tilting by a whole turn leaves numbers of 1e-16."""
    state = State(q=[3.1, 1.2, 1.8, 0.0], v=[0.0] * 4, a=[0.0] * 4)
    motors = Motors(constants=None, efficiency="gearbox")
    record = torque_record(a5.load(), state, motors, current=None)
    record["gravity"] = [-0.0, 4e-7, -6e-6]
    *_, assumptions = torque_lines(record)
    assert "gravity (0, 0, -6e-06) m/s^2" in assumptions
