"""The verification passes what is right and finds each mistake of public models."""

from __future__ import annotations

import json
import re
import shutil
import subprocess
import sys
import xml.etree.ElementTree as ET
from pathlib import Path

import numpy as np
import pytest
import reference
from urdf_edits import with_mass

import alpha5_model as a5
from alpha5_model._support.paths import JAWS_URDF_PATH, URDF_PATH
from alpha5_model.cli import main
from alpha5_model.description.reading import read_urdf
from alpha5_model.description.urdf import Variant, urdf
from alpha5_model.description.verification import (
    FileCheck,
    checks,
    frames,
    verify_generated,
    verify_urdf,
)
from alpha5_model.errors import FileFormatError, MissingFileError

LOCKED, JAWS = (Path(p).read_text("utf-8") for p in (URDF_PATH, JAWS_URDF_PATH))


def verdicts(rows: tuple[FileCheck, ...]) -> dict[str, str]:
    return {row.check: row.verdict for row in rows}


def failed(rows: tuple[FileCheck, ...]) -> set[str]:
    return {row.check for row in rows if row.verdict == "failed"}


def verify(text: str, folder: Path, **options: object) -> tuple[FileCheck, ...]:
    file = folder / "arm.urdf"
    file.write_text(text, "utf-8")
    return verify_urdf(file, samples=50, **options)  # type: ignore[arg-type]


# --- what is right --------------------------------------------------------------------


@pytest.mark.slow
def test_the_committed_files_pass() -> None:
    rows = verify_generated()
    assert {row.verdict for row in rows} <= {"passed", "not run"}
    assert verdicts(rows)["frames, Pinocchio"] == "passed"
    for row in rows:
        if row.check.startswith("frames"):
            assert row.measured is not None
            assert row.measured < 1e-12
    (closed,) = (row for row in rows if row.check == "closed jaws")
    assert closed.measured is not None
    # Computed inertias are written with 12 digits.
    assert closed.measured < 5e-12


@pytest.mark.parametrize(
    "variant",
    [
        Variant(
            prefix="left_",
            gripper="jaws",
            parent="vehicle",
            xyz=(0.1, 0.2, 0.3),
            rpy=(1, 2, 3),
        ),
        Variant(dh_frames=True, collision="none"),
        Variant(corrections=()),
        Variant(ros2_control=True, parent="world"),
    ],
)
def test_variants_pass(variant: Variant, tmp_path: Path) -> None:
    rows = verify(urdf(variant), tmp_path, corrections=tuple(variant.corrections))
    assert failed(rows) == set(), [r for r in rows if r.verdict == "failed"]
    if variant.dh_frames:
        (row,) = (r for r in rows if r.check == "frames, Pinocchio")
        assert row.finding.startswith("12 frames")


def test_the_letter_of_the_document_needs_its_name(tmp_path: Path) -> None:
    """link_0 turned by pi, without saying so, is a wrong placement."""
    rows = verify(urdf(Variant(corrections=())), tmp_path)
    assert {"frames, Pinocchio", "frames, yourdfpy"} <= failed(rows) | {
        "frames, yourdfpy"
    }
    assert "frames, Pinocchio" in failed(rows)


def test_the_dh_product_equals_the_tests_own() -> None:
    p = a5.parameters()
    q = reference.configurations(40, seed=3)
    ours = frames.dh_product(p, q)
    for k, row in enumerate(q):
        for name, theirs in zip(
            [f"dh_{i}" for i in range(1, 6)], reference.dh_frames(row)[1:], strict=True
        ):
            np.testing.assert_allclose(ours[name][k], theirs, atol=1e-14)
        for i, theirs in enumerate(reference.inertial_frames(row)):
            np.testing.assert_allclose(ours[f"link_{i}"][k], theirs, atol=1e-14)
        np.testing.assert_allclose(
            ours["tcp"][k], reference.dh_frames(row)[5], atol=1e-14
        )


def test_configurations_are_within_the_limits_and_at_all_corners() -> None:
    q = frames.configurations(a5.parameters(), 100)
    assert len({tuple(row) for row in q[:16].tolist()}) == 16
    assert set(q[:16].ravel()) == {*reference.LOWER, *reference.UPPER}
    assert ((q >= reference.LOWER) & (q <= reference.UPPER)).all()
    np.testing.assert_array_equal(q, frames.configurations(a5.parameters(), 100))


def test_the_frame_error_sees_position_and_orientation() -> None:
    here = np.eye(4)[None]
    turned = reference.rotation_z(1e-9)[None]
    half = reference.rotation_x(np.pi)[None]
    moved = np.eye(4)[None]
    moved = moved + np.array(
        [[0, 0, 0, 0], [0, 0, 0, 3e-7], [0, 0, 0, 4e-7], [0, 0, 0, 0]]
    )
    assert frames.frame_error(turned, here) == pytest.approx(1e-9, rel=1e-6)
    assert frames.frame_error(half, here) == pytest.approx(np.pi)
    assert frames.frame_error(moved, here) == pytest.approx(5e-7)


@pytest.mark.slow
def test_a_committed_file_that_cannot_be_read_has_failed(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setattr(checks, "URDF_PATH", str(tmp_path / "alpha5.urdf"))
    assert main(["check"]) == 1
    assert "no such file" in " ".join(capsys.readouterr().out.split())


# --- what is wrong --------------------------------------------------------------------


def inertia(xx: float, xy: float, xz: float, yy: float, yz: float, zz: float) -> str:
    values = zip(
        ("ixx", "ixy", "ixz", "iyy", "iyz", "izz"),
        (xx, xy, xz, yy, yz, zz),
        strict=True,
    )
    return "<inertia " + " ".join(f'{k}="{v * 1e-6!r}"' for k, v in values) + "/>"


def replace_inertia(text: str, link: str, new: str) -> str:
    pattern = rf'(<link name="{link}">.*?)<inertia [^>]*/>'
    changed, count = re.subn(
        pattern, lambda m: m.group(1) + new, text, count=1, flags=re.S
    )
    assert count == 1
    return changed


def swap(text: str, old: str, new: str) -> str:
    assert text.count(old) >= 1, old
    return text.replace(old, new, 1)


#: Name -> (the wrong URDF, the checks that must fail, a word of the finding)
WRONG = {
    "products with SolidWorks' sign": (
        replace_inertia(
            LOCKED, "link_2", inertia(82.697, -74.836, -1.866, 847.148, 0.317, 868.483)
        ),
        {"inertias"},
        "SolidWorks' sign",
    ),
    "products left out": (
        replace_inertia(LOCKED, "link_3", inertia(63.596, 0, 0, 40.651, 0, 75.158)),
        {"inertias"},
        "from Table 2's I_COM",
    ),
    "I_Link in place of I_COM": (
        replace_inertia(
            LOCKED,
            "link_4",
            inertia(4233.813, -0.083, 6.827, 4242.419, -52.693, 63.355),
        ),
        {"inertias"},
        "it is I_Link",
    ),
    "one digit of a tensor": (
        swap(LOCKED, 'izz="0.000868483"', 'izz="0.000868484"'),
        {"inertias"},
        "link_2",
    ),
    "the last bit of a mass": (
        swap(LOCKED, 'mass value="0.355"', 'mass value="0.35500000000000004"'),
        {"inertias"},
        "0.35500000000000004",
    ),
    "a COM in the DH frame of the link": (
        # {1} of Section 2 is at the origin of DH {0}. The link's DH frame is 20 mm out
        # and 46.2 mm up.
        swap(
            LOCKED,
            'xyz="0.007746 0.000112 0.025038"',
            'xyz="-0.012254 -0.021162 -0.000112"',
        ),
        {"inertias"},
        "mm from Table 2's",
    ),
    "a COM in millimetres": (
        swap(LOCKED, 'xyz="0.073563 -9.1e-05 -0.000734"', 'xyz="73.563 -0.091 -0.734"'),
        {"inertias"},
        "link_2: COM",
    ),
    "a turned inertial frame": (
        LOCKED.replace(
            '<origin rpy="0 0 0" xyz="0.011188',
            '<origin rpy="0 0 1.5708" xyz="0.011188',
        ),
        {"inertias"},
        "link_3: inertia",
    ),
    "a joint 0.8 mm too high": (
        swap(LOCKED, 'xyz="0.02 0.0 0.0462"', 'xyz="0.02 0.0 0.047"'),
        {"frames, Pinocchio"},
        "largest at",
    ),
    "a joint turned by 1e-9 rad": (
        swap(LOCKED, '1.3021582029078473 0.0"', '1.3021582039078473 0.0"'),
        {"frames, Pinocchio"},
        "largest at",
    ),
    "a joint that turns the other way": (
        swap(
            LOCKED,
            '<child link="link_3"/>\n    <axis xyz="0 0 1"/>',
            '<child link="link_3"/>\n    <axis xyz="0 0 -1"/>',
        ),
        {"joints", "frames, Pinocchio"},
        "axis_c: axis",
    ),
    "wider limits": (
        swap(LOCKED, 'upper="6.143"', 'upper="6.3"'),
        {"joints"},
        "axis_e: limits",
    ),
    "a joint without limits": (
        swap(
            LOCKED,
            '<limit effort="9.0" lower="0.01745" upper="6.143" '
            'velocity="0.5235987755982988"/>',
            "",
        ),
        {"joints", "frames, Pinocchio"},
        "axis_e: limits {'lower': None",
    ),
    "a frozen wrist": (
        swap(LOCKED, 'name="axis_b" type="revolute"', 'name="axis_b" type="fixed"'),
        {"joints", "frames, Pinocchio"},
        "axis_b: type fixed",
    ),
    "a missing link": (
        re.sub(
            r'<link name="tcp">.*?</link>|<joint name="tcp_fixed".*?</joint>',
            "",
            LOCKED,
            flags=re.S,
        ),
        {"names", "frames, Pinocchio", "frames, yourdfpy"},
        "no link tcp",
    ),
    "a dummy link that weighs": (
        re.sub(
            r'(<link name="tcp">\s*<inertial>.*?)<mass value="0"/>\s*<inertia [^>]*/>',
            r"\1<mass value='1e-4'/>" + inertia(100, 0, 0, 100, 0, 100),
            LOCKED,
            flags=re.S,
        ),
        {"stray masses"},
        "tcp: mass 0.0001 kg",
    ),
    "a massless frame that does not say so": (
        re.sub(
            r'(<link name="tcp">\s*)<inertial>.*?</inertial>', r"\1", LOCKED, flags=re.S
        ),
        {"stray masses"},
        "tcp: no inertial",
    ),
    "an impossible body": (
        replace_inertia(LOCKED, "link_3", inertia(10, 0, 0, 10, 0, 75.158)),
        {"inertias", "physics"},
        "exceeds the sum",
    ),
    "a link without an inertial": (
        re.sub(
            r'(<link name="link_2">\s*)<inertial>.*?</inertial>',
            r"\1",
            LOCKED,
            flags=re.S,
        ),
        {"inertias"},
        "link_2: no inertial",
    ),
    "a heavier finger": (
        swap(JAWS, 'mass value="0.01647"', 'mass value="0.01648"'),
        {"closed jaws"},
        "",
    ),
    "a displaced finger": (
        swap(JAWS, 'xyz="-0.0155 0.0 -0.13965"', 'xyz="-0.0155 0.0 -0.1396"'),
        {"closed jaws"},
        "",
    ),
    "a link 4 that was not taken apart": (
        with_mass(JAWS, "0.355", "link_4"),
        {"closed jaws"},
        "",
    ),
    "a finger that closes beyond its limit": (
        JAWS.replace('upper="0.612"', 'upper="0.4"'),
        {"jaw limits"},
        "the rod makes it 0.612",
    ),
    "a finger that follows nothing": (
        re.sub(r"<mimic [^>]*/>", "", JAWS, count=1),
        {"jaw limits"},
        "no joint that follows axis_a",
    ),
}


@pytest.mark.slow
@pytest.mark.parametrize("mistake", WRONG)
def test_a_mistake_is_caught(mistake: str, tmp_path: Path) -> None:
    text, checks, words = WRONG[mistake]
    assert text not in (LOCKED, JAWS)
    rows = verify(text, tmp_path)
    not_run = {row.check for row in rows if row.verdict == "not run"}
    assert checks - not_run <= failed(rows), failed(rows)
    assert words in " ".join(row.finding for row in rows if row.verdict == "failed")
    if "frames, Pinocchio" not in checks and "names" not in checks:
        assert "frames, Pinocchio" not in failed(rows)  # and nothing else is blamed


def test_what_the_closed_jaws_lack_is_told_in_parts_of_its_block(
    tmp_path: Path,
) -> None:
    """Second moments are half the trace less the inertia.

    A tensor that is larger about all axes therefore adds half as much.
    """
    more = 1e-6
    root = ET.fromstring(JAWS)
    for axes in ("ixx", "iyy", "izz"):
        tensor = root.find("link[@name='finger_1']/inertial/inertia")
        tensor.set(axes, repr(float(tensor.get(axes)) + more))
    rows = verify(ET.tostring(root, encoding="unicode"), tmp_path)
    (row,) = [row for row in rows if row.check == "closed jaws"]
    xx, yy, zz = (x * 1e-6 for x in reference.INERTIA[4][:3])
    # Most of link 4 lies along its z axis, whose second moment is (xx + yy - zz) / 2.
    largest = (xx + yy - zz) / 2 + reference.MASS[4] * (reference.COM[4][2] * 1e-3) ** 2
    assert row.measured == pytest.approx(more / 2 / largest, rel=1e-4)


UNREADABLE = {
    "a missing link that a joint needs": (
        re.sub(r'<link name="link_4">.*?</link>', "", LOCKED, flags=re.S),
        "joint 'axis_b': no link 'link_4'",
    ),
    "not XML": (LOCKED[:500], "not XML"),
    "not a robot": ("<sdf/>", "expected <robot>, got <sdf>"),
    "text for a number": (
        LOCKED.replace('ixx="4.5012e-05"', 'ixx="abc"'),
        "<inertia ixx>: expected a finite number, got 'abc'",
    ),
    "NaN": (
        LOCKED.replace('mass value="0.234"', 'mass value="nan"'),
        "<mass value>: expected a finite number",
    ),
    "two numbers for three": (
        LOCKED.replace('xyz="0.02 0.0 0.0462"', 'xyz="0.02 0.0"'),
        "<origin xyz>: expected 3 finite numbers",
    ),
    "a link twice": (
        LOCKED.replace('<link name="link_1">', '<link name="link_2">'),
        "link 'link_2' is there twice",
    ),
    "half a tensor": (
        LOCKED.replace('ixy="-2.832e-06"', ""),
        "<inertia> has no attribute 'ixy'",
    ),
    "no child": (
        LOCKED.replace('<child link="link_3"/>', ""),
        "joint 'axis_c' has no <child>",
    ),
}


@pytest.mark.parametrize("kind", UNREADABLE)
def test_what_cannot_be_read_is_one_line_and_status_2(
    kind: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    text, words = UNREADABLE[kind]
    file = tmp_path / "arm.urdf"
    file.write_text(text, "utf-8")
    with pytest.raises(FileFormatError, match=re.escape(words)):
        read_urdf(file)
    assert main(["check", "--urdf", str(file)]) == 2
    captured = capsys.readouterr()
    assert captured.err.count("\n") == 1
    assert words in captured.err
    assert captured.out == ""


@pytest.mark.slow
@pytest.mark.parametrize(
    ("old", "new"),
    [
        ("</robot>", '<xacro:include filename="x"/></robot>'),
        ('rpy="0.0 1.57', 'rpy="inf 1.57'),
        ('xyz="0 0 0"', 'xyz="0 0 inf"'),
    ],
    ids=["undeclared prefix", "infinite angle", "infinite place"],
)
def test_other_readers_say_nothing_on_stderr(
    old: str, new: str, tmp_path: Path
) -> None:
    """In a process of its own, since pytest takes what is logged."""
    path = tmp_path / "arm.urdf"
    text = Path(URDF_PATH).read_text(encoding="utf-8")
    assert old in text
    path.write_text(text.replace(old, new, 1), encoding="utf-8")
    command = [sys.executable, "-m", "alpha5_model", "check", "--urdf", str(path)]
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    assert done.stderr.count("\n") == (done.returncode == 2), done.stderr


def test_a_missing_file(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    with pytest.raises(MissingFileError):
        verify_urdf(tmp_path / "none.urdf")
    assert main(["check", "--urdf", str(tmp_path / "none.urdf")]) == 2
    assert "no such file; expected a URDF file" in capsys.readouterr().err


# --- tools that are not there are never a pass ----------------------------------------


def test_missing_tools_are_not_run(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(shutil, "which", lambda *_, **__: None)
    monkeypatch.setitem(sys.modules, "yourdfpy", None)
    found = verdicts(verify_urdf(URDF_PATH, samples=1))
    assert found["check_urdf"] == "not run"
    assert found["frames, yourdfpy"] == "not run"
    assert found["frames, Pinocchio"] == "passed"


# --- the command ----------------------------------------------------------------------


@pytest.mark.slow
def test_a_differing_document_is_not_a_failure(
    capsys: pytest.CaptureFixture[str],
) -> None:
    assert main(["check", "--json"]) == 0
    content = json.loads(capsys.readouterr().out)
    assert content["passed"] is True
    assert {"agrees", "differs", "impossible"} == {
        row["verdict"] for row in content["document"]
    }
    assert [row["claim"] for row in content["document"]] == [
        row.claim for row in a5.audit()
    ]
    categories = {row["claim"]: row["category"] for row in content["document"]}
    assert categories == {row.claim: row.category for row in a5.audit()}
    assert set(categories.values()) == {"error", "reading", "transcription", None}
    assert {row["file"] for row in content["files"]} == {
        "alpha5.urdf",
        "alpha5_jaws.urdf",
    }


def test_a_failing_file_is_status_1(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    file = tmp_path / "other.urdf"
    file.write_text(WRONG["I_Link in place of I_COM"][0], "utf-8")
    assert main(["check", "--urdf", str(file)]) == 1
    out = capsys.readouterr().out
    assert "it is I_Link" in " ".join(out.split())
    assert "1 failed" in out.splitlines()[0]
    assert "The documents against themselves" not in out


def test_corrections_of_another_file(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    file = tmp_path / "letter.urdf"
    file.write_text(urdf(Variant(corrections=())), "utf-8")
    assert main(["check", "--urdf", str(file)]) == 1
    assert main(["check", "--urdf", str(file), "--corrections", ""]) == 0
    capsys.readouterr()
    assert main(["check", "--urdf", str(file), "--corrections", "base"]) == 2
    assert "choose from base_frame" in capsys.readouterr().err
    assert main(["check", "--corrections", ""]) == 2
    assert "--urdf FILE" in capsys.readouterr().err


def test_a_finger_on_another_link_is_no_split_of_link_4(tmp_path: Path) -> None:
    head, joint, tail = JAWS.partition('<joint name="finger_1_joint"')
    for parent in ("link_3", "link_4", "tcp"):
        text = head + joint + tail.replace("link_4", parent, 1)
        (row,) = (r for r in verify(text, tmp_path) if r.check == "closed jaws")
        own = "wrist, rod and fingers have link 4's"
        assert (own if parent == "link_4" else "not all there") in row.finding


def test_without_a_base_link_there_is_no_prefix(tmp_path: Path) -> None:
    found = verify(LOCKED.replace('"base_link"', '"bottom"'), tmp_path)
    assert "base_link" in " ".join(
        row.finding for row in found if row.verdict == "failed"
    )
