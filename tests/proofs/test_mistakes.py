"""`compare` finds, names and mends every single mistake at every place.

The mistakes are made in our own URDFs, by `damaged_models`: both that are shipped, and
an arm of one's own on a mount. Each file is judged by `compare` alone: the mistake is
found at its link or joint, it is named by its id, and the file agrees once the advice
is followed. Weight torques and tool are then ours, by Pinocchio.
"""

from __future__ import annotations

import functools
import itertools
import re
import tempfile
from pathlib import Path

import damaged_models as dm
import numpy as np
import pinocchio as pin
import pytest

import alpha5_model as a5
from alpha5_model.description.urdf import Variant, urdf
from alpha5_model.errors import ImplausibleWarning
from alpha5_model.numbers.parameters import Alpha5Parameters
from alpha5_model.proofs.comparison.mistakes import FITTED, MISTAKES
from alpha5_model.proofs.comparison.result import Comparison

#: How many of the single mistakes the fast test makes.
SAMPLE = 60
PAIRS = 100
OWN_ARM = """
format = 1
name = "longer_arm"
[mount]
parent = "vehicle"
xyz = {value = [210, 40, -85], unit = "mm"}
rpy = {value = [180, 0, 30], unit = "deg"}
[lengths]
a_0 = {value = 26, unit = "mm"}
a_1 = {value = 190, unit = "mm"}
[links.link_2]
mass = {value = 341, unit = "g"}
com = {value = [81.5, 2.25, -1.125], unit = "mm"}
"""


class Arm:
    """An arm whose URDF is damaged."""

    def __init__(self, text: str, record: Alpha5Parameters | None) -> None:
        self.text = text
        self.record = record
        self.mistakes = dm.single_mistakes(text, of_document=record is None)
        model = pin.buildModelFromXML(text)
        self.states = np.random.default_rng(5).uniform(-1, 1, (10, model.nq))
        self.states[:, 4:] = 0.0  # jaws stay closed
        self.weight, self.tools = measured(text, self.states)


def measured(text: str, states: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Torques of the arm's joints in air [N m] and positions of the tool [m]."""
    model = pin.buildModelFromXML(text)
    data = model.createData()
    tool = model.getFrameId(next(f.name for f in model.frames if f.name[-3:] == "tcp"))
    torques, tools = [], []
    for q in states:
        torques.append(pin.computeGeneralizedGravity(model, data, q)[:4].copy())
        pin.framesForwardKinematics(model, data, q)
        tools.append(data.oMf[tool].translation.copy())
    return np.array(torques), np.array(tools)


@functools.cache
def arm(name: str) -> Arm:
    if name == "locked":
        return Arm(Path(a5.URDF_PATH).read_text("utf-8"), None)
    if name == "jaws":
        path = Path(a5.URDF_PATH).with_name("alpha5_jaws.urdf")
        return Arm(path.read_text("utf-8"), None)
    record = own_record()
    return Arm(urdf(Variant(arm=record)), record)


@functools.cache
def own_record() -> Alpha5Parameters:
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "own.toml"
        path.write_text(OWN_ARM, encoding="utf-8")
        with pytest.warns(ImplausibleWarning, match="a_1"):
            return a5.arm_file(path)


def compared(text: str, record: Alpha5Parameters | None, folder: Path) -> Comparison:
    path = folder / "other.urdf"
    path.write_text(text, encoding="utf-8")
    return a5.compare(path, arm=record, samples=20)


def place_in_ours(where: str) -> str:
    """Where `compare` reports a link of ours: opened jaws are parts of link_4."""
    return "link_4" if where in ("jaw_rod", "finger_1", "finger_2") else where


def faults(one: Arm, damages: list[dm.Damage], folder: Path) -> list[str]:
    """What `compare` misses of a file: found, named, mended; empty if nothing."""
    text = dm.damaged(one.text, *damages)
    result = compared(text, one.record, folder)
    missed = []
    for damage in damages:
        place = place_in_ours(damage.where)
        there = [f for f in result.findings if f.serious and f.where == place]
        if not there:
            missed.append(f"{damage.label}: not found")
        elif not any({f.mistake, f.id} & damage.names for f in there):
            got = [f.mistake or f.id for f in there]
            missed.append(f"{damage.label}: not named, but {got}")

    corrections = itertools.chain(*(f.corrections for f in result.findings))
    mended = dm.apply(text, corrections)
    again = compared(mended, one.record, folder)
    if not again.agrees:
        left = [(f.id, f.where) for f in again.findings if f.serious]
        return [*missed, f"{damages[0].label}: not mended: {left}"]
    weight, tools = measured(mended, one.states)
    if not np.allclose(weight, one.weight, rtol=0, atol=1e-5):
        missed.append(f"{damages[0].label}: mended to other torques")
    if np.abs(tools - one.tools).max() > 1e-4:
        missed.append(f"{damages[0].label}: mended to another tool")
    return missed


@functools.cache
def sample() -> list[tuple[Arm, dm.Damage]]:
    """Some of the mistakes of both shipped arms."""
    every = [(arm(name), d) for name in ("locked", "jaws") for d in arm(name).mistakes]
    chosen = np.random.default_rng(24).choice(len(every), SAMPLE, replace=False)
    return [every[k] for k in chosen]


def counted(missed: list[str], files: int) -> None:
    """All are found and mended, at least 95 % are named."""
    unnamed = [line for line in missed if "not named" in line]
    others = [line for line in missed if line not in unnamed]
    assert not others, "\n".join(others)
    assert len(unnamed) <= 0.05 * files, "\n".join(unnamed)


@pytest.mark.parametrize("k", range(SAMPLE))
def test_a_mistake_is_found_named_and_mended(k: int, tmp_path: Path) -> None:
    one, damage = sample()[k]
    assert faults(one, [damage], tmp_path) == []


@pytest.mark.slow
@pytest.mark.parametrize("name", ["locked", "jaws", "own"])
def test_every_mistake_is_found_named_and_mended(name: str, tmp_path: Path) -> None:
    one = arm(name)
    missed = []
    for damage in one.mistakes:
        missed += faults(one, [damage], tmp_path)
    assert len(one.mistakes) > 200
    counted(missed, len(one.mistakes))


@pytest.mark.slow
def test_random_pairs_are_found_named_and_mended(tmp_path: Path) -> None:
    rng = np.random.default_rng(100)
    missed = []
    for _ in range(PAIRS):
        one = arm(rng.choice(["locked", "jaws", "own"]))
        while True:
            pair = [one.mistakes[k] for k in rng.choice(len(one.mistakes), 2)]
            if pair[0].place != pair[1].place:
                break
        missed += faults(one, pair, tmp_path)
    counted(missed, 2 * PAIRS)


@pytest.mark.parametrize("name", ["locked", "jaws", "own"])
def test_an_undamaged_file_agrees(name: str, tmp_path: Path) -> None:
    assert compared(arm(name).text, arm(name).record, tmp_path).agrees


def rewritten(text: str, style: str) -> str:
    """The URDF with other digits in its inertials."""

    def styled(numbers: str) -> str:
        return " ".join(style % float(x) for x in numbers.split())

    root = dm.ET.fromstring(text)
    for inertial in root.iter("inertial"):
        mass, origin, inertia = map(inertial.find, ("mass", "origin", "inertia"))
        mass.set("value", styled(mass.get("value")))
        origin.set("xyz", styled(origin.get("xyz")))
        for name, value in inertia.attrib.items():
            inertia.set(name, styled(value))
    return dm.ET.tostring(root, encoding="unicode")


@pytest.mark.parametrize("style", ["%.3g", "%.4g", "%.6f", "%.9f", "%.3e"])
def test_a_file_with_fewer_digits_agrees(style: str, tmp_path: Path) -> None:
    assert compared(rewritten(arm("locked").text, style), None, tmp_path).agrees


@pytest.mark.parametrize("style", ["%.2g", "%.5f"])
def test_too_few_digits_are_named(style: str, tmp_path: Path) -> None:
    result = compared(rewritten(arm("locked").text, style), None, tmp_path)
    bodies = [f for f in result.findings if f.id.startswith("body.") and f.serious]
    assert {f.mistake for f in bodies} == {"rounded"}


def test_a_sign_is_found_to_the_last_digit(tmp_path: Path) -> None:
    """Ten units of Table 2's last digit, in a file of three significant figures."""
    text = rewritten(arm("locked").text, "%.3g")
    wrong = text.replace('iyz="1e-08"', 'iyz="-1e-08"')
    assert wrong != text
    result = compared(wrong, None, tmp_path)
    assert [f.mistake for f in result.findings if f.serious] == ["sign_iyz"]


@pytest.mark.parametrize(
    ("per_si", "mistake"), [(1e6, "kg_mm2_solidworks"), (1e9, "g_mm2_solidworks")]
)
def test_a_tensor_pasted_as_solidworks_prints_it_is_named(
    per_si: float, mistake: str, tmp_path: Path
) -> None:
    """Unit and signs are wrong at once: the document prints kg mm^2 so."""
    one = arm("locked")
    for link in ("link_0", "link_3"):
        body = dm.inertial(dm.named(dm.ET.fromstring(one.text), "link", link))
        printed = (2 * np.diag(np.diag(body.inertia)) - body.inertia) * per_si
        damage = dm.Damage(mistake, link, "inertia", printed, frozenset([mistake]))
        assert faults(one, [damage], tmp_path) == []


@pytest.mark.parametrize("quantity", ["mass", "com", "inertia"])
def test_no_mistake_is_named_for_random_numbers(quantity: str, tmp_path: Path) -> None:
    """The judge sees a wrong name: what no mistake gives is found, but not named."""
    rng = np.random.default_rng(3)
    one = arm("locked")
    body = dm.inertial(dm.named(dm.ET.fromstring(one.text), "link", "link_2"))
    for _ in range(3):
        turn = pin.exp3(rng.uniform(-2, 2, 3))
        moments = np.linalg.eigvalsh(body.inertia) * rng.uniform(1.1, 1.4, 3)
        values = {
            "mass": np.array(body.mass * rng.uniform(1.1, 1.5)),
            "com": body.com + rng.uniform(0.01, 0.02, 3),
            "inertia": turn @ np.diag(moments) @ turn.T,
        }
        change = dm.Damage("random", "link_2", quantity, values[quantity])
        result = compared(dm.damaged(one.text, change), None, tmp_path)
        found = {f.id: f.mistake for f in result.findings if f.serious}
        assert found[f"body.{quantity}"] == ""
        assert not any(found.values())


def test_the_guide_lists_every_mistake() -> None:
    """Its ids, with ranges such as `dh_0` to `dh_5`, are those of the table."""
    guide = Path(__file__).parents[2] / "docs" / "guides" / "compare.md"
    text = guide.read_text("utf-8").partition("## Mistakes that it names")[2]
    listed = set()
    for first, last in re.findall(r"`(\w+_\d)` to `(\w+_\d)`", text):
        stem = first[:-1]
        listed |= {f"{stem}{k}" for k in range(int(first[-1]), int(last[-1]) + 1)}
    listed |= set(re.findall(r"`([a-z]\w*)`", text.partition("\n\nOf joints")[0]))
    ids = {mistake.id for mistake in (*MISTAKES, *FITTED)}
    assert ids <= listed
    of_other_numbers = {"earlier_revision", "catalogue"}
    assert listed - ids == {"other_frame", "rounded", *of_other_numbers}
