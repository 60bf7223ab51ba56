"""Each measured number in the documentation is computed again, or is listed here.

A measured number (a share, an error, a ratio, a count of samples) has a statement in
one of the modules ``test_statements_*.py``, or is in `ELSEWHERE` with its test or
script.
"""

from __future__ import annotations

import ast
import re
from pathlib import Path

import pytest
import test_statements_concepts
import test_statements_package
import test_statements_proof
from statement_registry import REPOSITORY, STATEMENTS, one_line, text_of

MODULES = (test_statements_concepts, test_statements_package, test_statements_proof)
#: What a measured number looks like: a share, an uncertainty, a factor, a small bound,
#: a count of samples, a time.
MEASURED = re.compile(
    r"\d ?%|± ?\d|R² (?:is )?\d|\d+(?:\.\d+)? times\b|\d(?:\.\d+)?e-\d+"
    r"|\b\d{1,3}(?: \d{3})+\b"
    r"|10[⁴⁵⁶⁷⁸⁹⁻]|\d ?(?:µs|ns|ms)\b"
)
#: Of docstrings and data, where small bounds are mostly settings.
SHARES = re.compile(r"\d ?%(?![(}])|R² (?:is )?\d|± ?\d")
#: Pages that a program writes, that keep what was said at a time, or that another
#: test reads.
LEFT_OUT = {
    "docs/validity.md",  # test_validity.py reads each row
    "docs/speed.md",
    "docs/changelog.md",
    "docs/commands.md",
    "docs/architecture.md",
}
#: Page -> words -> the test that holds them, or the script that measures them.
ELSEWHERE: dict[str, dict[str, str]] = {
    "docs/conformance.md": {
        "SAPIEN gives a link without mass, the tcp, 1e-6 kg m²": (
            "scripts/conformance/simulators.py"
        ),
    },
    "docs/concepts/uncertainty.md": {
        "did the 95 % intervals contain the true value": (
            "tests/studies/test_uncertainty.py::test_identification_finds_the_truth"
        ),
        "| efforts | white | 95.6 % | 96.0 %": (
            "scripts/identification/identify_trials.py"
        ),
        "sample | 94.5 % | 93.7 %": ("scripts/identification/identify_trials.py"),
        "| efforts | rounded | 94.6 % | 94.6 %": (
            "scripts/identification/identify_trials.py"
        ),
        "| load on the mount | white | 94.5 % | 95.9 %": (
            "scripts/identification/identify_trials.py"
        ),
        "sample | 93.7 % | 95.1 %": ("scripts/identification/identify_trials.py"),
        "| load on the mount | rounded | 94.6 % | 95.4 %": (
            "scripts/identification/identify_trials.py"
        ),
        "Fresh water for sea water and a scale of 1.6 % change": (
            "scripts/identification/identify_trials.py"
        ),
        "put the fluid first in 72 % of recordings": (
            "scripts/identification/identify_trials.py"
        ),
        "A link 2 that is 5 % too heavy looks like a heavier link 3": (
            "scripts/identification/identify_trials.py"
        ),
        "the fits would put link 2 first in 91 % of recordings": (
            "scripts/identification/identify_trials.py"
        ),
    },
    "docs/guides/motors.md": dict.fromkeys(
        (
            "ripples by 5 % and drifts by 4 %",
            "| 280 mA, `axis_d` | 1.1 % | 0.5 % | 9.2 %",
            "| 280 mA, `axis_c` | 1.0 % | 1.3 % | 4.3 %",
            "| 43 mA, `axis_d` | 3.5 % | 3.3 % | 5.0 %",
            "| 43 mA, `axis_c` | 3.2 % | 3.8 % | 4.3 %",
            "| 43 mA, `axis_d` | 1.7 % | 1.8 %",
            "| 43 mA, `axis_c` | 2.1 % | 2.2 %",
            "the printed digits know gravity's torque to 0.4 %",
        ),
        "scripts/identification/motor_trials.py",
    ),
    "docs/concepts/dexterity.md": {
        "as 3600 orientations": (
            "tests/documentation/test_statements_concepts.py::test_the_page_says_what_is_computed"
        ),
    },
    "docs/errata.md": {
        "(100 000 points": (
            "tests/documentation/test_statements_concepts.py"
            "::test_the_page_says_what_is_computed"
        ),
    },
    "docs/guides/calibration.md": {
        "the gain of the sensor, which is known to 1 %": (
            "scripts/studies/excitation_bound.py"
        ),
        "95 % held the truth": ("scripts/studies/calibration_trials.py"),
        "grams | 95.2 % | 95.2 %": ("scripts/studies/calibration_trials.py"),
        "grams | 94.0 % | 93.5 %": ("scripts/studies/calibration_trials.py"),
        "white | 96.5 % | 96.5 %": ("scripts/studies/calibration_trials.py"),
        "drift | 98.7 % | 99.3 %": ("scripts/studies/calibration_trials.py"),
        "rounded | 95.3 % | 97.7 %": ("scripts/studies/calibration_trials.py"),
        "white | 95.2 % | 96.5 %": ("scripts/studies/calibration_trials.py"),
        "drift | 98.1 % | 99.7 %": ("scripts/studies/calibration_trials.py"),
        "rounded | 95.1 % | 96.8 %": ("scripts/studies/calibration_trials.py"),
        "0.1°, its stiffness known to 2 %": (
            "tests/documentation/test_statements_calibration.py::test_what_a_sensor_tells"
        ),
        "5 % from the rated speeds": (
            "tests/studies/test_calibration.py::test_an_exciting_motion_can_be_made"
        ),
    },
    "alpha5_model/studies/calibration/excitation.py": {
        "within 95 % of the rated speeds": (
            "tests/studies/test_calibration.py::test_an_exciting_motion_can_be_made"
        ),
    },
    "docs/guides/compare.md": {
        "100 levels of elements or 10 000 links": (
            "tests/description/test_hostile_urdf.py::test_the_bounds_are_said"
        ),
    },
    "docs/guides/moving-water.md": {
        "median over 20 000 random poses and directions": (
            "tests/water/test_moving_water_commands.py::test_the_documented_table_of_loads_is_the_strips"
        ),
        "moves in random directions, 98 % of the motions have": (
            "scripts/hydrodynamics/added_mass.py"
        ),
    },
    "docs/proof.md": {
        "multi-start numerical minimisation | 1e-13 m": (
            "tests/documentation/test_statements_proof.py::HELD"
        ),
        "forward of inverse dynamics | 1e-10 relative": (
            "tests/documentation/test_statements_proof.py::HELD"
        ),
        "power balance; energy of an undamped run | 1e-8 relative; 1e-8 J": (
            "tests/documentation/test_statements_proof.py::HELD"
        ),
        "a cylinder's closed forms; MuJoCo's ellipsoid | 1e-12; 1e-7 relative": (
            "tests/documentation/test_statements_proof.py::HELD"
        ),
        "cylinders by rings of sources | 1.5 %": (
            ""
            "tests/documentation/test_statements_proof.py::test_the_script_refuses_what_the_page_says_of_added_mass"
        ),
    },
    "alpha5_model/description/templates/mjcf_readme.md": {
        "with an error of 4e-10 kg m^2": "tests/description/test_mjcf.py",
        "Newton replaces smaller ones by 1e-6": "scripts/conformance/simulators.py",
        "change the mass matrix by less than 1e-13 kg m^2": (
            "tests/description/test_mjcf.py"
        ),
    },
    "alpha5_model/trajectory/smoothing.py": {
        "below this a sine's amplitude is off by more than 0.1 %": (
            "tests/trajectory/test_trajectory_smoothing.py"
        ),
    },
    "alpha5_model/numbers/estimated_hydrodynamics.toml": {
        "are 0.4 to 1.4 % apart at most": "scripts/hydrodynamics/added_mass.py",
    },
}
#: Words that give a meaning and measure nothing: units, definitions, what a document
#: prints.
MEANING = {
    "0.1 for 10 %",
    "3.752 Nmm +- 10 %",
    "a 95 % interval",
    "95 % intervals, (38,) each",
    "(1, 50 and 99 %)",
    "masses and volumes are known to 10 %",
    "standard deviation of masses and volumes is 10 %",
    "that of moments of inertia 10 % of the largest",
    "force-torque sensor in sea water, 3 mN·m, gain 1 %",
    "efforts without friction in sea water, 3 mN·m, gain 1 %",
    "at steps of 1 ms",
}


def prose(page: str) -> str:
    """A page on one line, without code and without text that a program wrote."""
    text = text_of(page)
    if page.endswith(".md"):
        text = re.sub(r"^```.*?^```", "", text, flags=re.DOTALL | re.MULTILINE)
        text = re.sub(
            r"<!-- [\w ]+: begin -->.*?<!-- [\w ]+: end -->", "", text, flags=re.DOTALL
        )
        text = re.sub(
            r"<!-- generated: \w+ -->.*?<!-- end -->", "", text, flags=re.DOTALL
        )
    elif page.endswith(".py"):
        text = " ".join([*docstrings(text), *re.findall(r"#:? (.*)", text)])
    return one_line(text)


def docstrings(source: str) -> list[str]:
    """Those of a module, its classes and functions."""
    kinds = ast.Module, ast.ClassDef, ast.FunctionDef, ast.AsyncFunctionDef
    nodes = [node for node in ast.walk(ast.parse(source)) if isinstance(node, kinds)]
    return [ast.get_docstring(node) or "" for node in nodes]


def pages() -> dict[str, re.Pattern[str]]:
    """Every page, module and text of data, with what is looked for in it."""
    found: dict[str, re.Pattern[str]] = {"README.md": MEASURED}
    for folder in ("docs", "alpha5_model/description/templates"):
        found |= {
            relative(p): MEASURED for p in sorted((REPOSITORY / folder).rglob("*.md"))
        }
    modules = sorted((REPOSITORY / "alpha5_model").rglob("*.py"))
    found |= {relative(p): SHARES for p in modules if "generated" not in p.parts}
    for page in (
        "numbers/corrections.toml",
        "numbers/estimated_hydrodynamics.toml",
        "cli/words.toml",
    ):
        found[f"alpha5_model/{page}"] = SHARES
    return {page: pattern for page, pattern in found.items() if page not in LEFT_OUT}


def relative(path: Path) -> str:
    return path.relative_to(REPOSITORY).as_posix()


def unknown(page: str, pattern: re.Pattern[str]) -> list[str]:
    """Numbers of a page that no statement has, with the words around them."""
    text = prose(page)
    known: list[tuple[int, int]] = []
    for item in STATEMENTS:
        if item.page == page and (found := item.found()):
            words = one_line(found[0])
            start = text.find(words)
            known.append((start, start + len(words)))
    for words in [*ELSEWHERE.get(page, {}), *MEANING]:
        start = text.find(words)
        if start >= 0:
            known.append((start, start + len(words)))
    out = []
    for match in pattern.finditer(text):
        if not any(
            start <= match.start() and match.end() <= end + 3 for start, end in known
        ):
            out.append(text[max(0, match.start() - 60) : match.end() + 30])
    return out


@pytest.mark.parametrize(("page", "pattern"), pages().items(), ids=[*pages()])
def test_every_measured_number_is_computed_again(
    page: str, pattern: re.Pattern[str]
) -> None:
    assert unknown(page, pattern) == [], (
        "register these in tests/test_statements_*.py, "
        "or say in ELSEWHERE what holds them"
    )


def test_what_is_held_elsewhere_is_there() -> None:
    for page, entries in ELSEWHERE.items():
        for words, place in entries.items():
            assert words in prose(page), f"{page} does not say {words!r}"
            file, _, name = place.partition("::")
            assert (REPOSITORY / file).is_file(), place
            assert re.search(rf"\b{name}\b", text_of(file)), place


def test_a_number_without_a_statement_is_seen() -> None:
    assert MEASURED.search("faster by 12 % than before")
    assert MEASURED.search("of 20 000 poses")
    assert MEASURED.search("to 3e-12 m")
    assert MEASURED.search("R² is 0.97")
    assert not MEASURED.search("Section 2.1, Table 2, link 3")
    assert len(STATEMENTS) > 40
    assert {item.figures.__module__ for item in STATEMENTS} == {
        m.__name__ for m in MODULES
    }
