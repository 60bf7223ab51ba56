"""A comparison as a JUnit report, the form of test results that CI services read."""

from __future__ import annotations

import re
import xml.etree.ElementTree as ET

from alpha5_model.numbers.tables import BODY_NAMES
from alpha5_model.proofs.comparison.result import Comparison, Finding

#: What passes if nothing serious is found there.
_PARTS = (*BODY_NAMES, "axis_e", "axis_d", "axis_c", "axis_b", "base", "tool")
#: Characters that XML cannot hold.
_NOT_XML = re.compile("[^\t\n\r\x20-\ud7ff\ue000-\ufffd\U00010000-\U0010ffff]")


def junit_report(comparison: Comparison, name: str) -> str:
    """The text of the report.

    Each serious finding is a test that failed, and each link, joint, base and tool
    without one is a test that passed. Remarks are printed in the test of their place.

    Args:
        comparison: What was found.
        name: Of the test suite, such as the file's.
    """
    failed = [found for found in comparison.findings if found.serious]
    remarks = [found for found in comparison.findings if not found.serious]
    wrong = {found.where for found in failed}
    parts = [*_PARTS, *(found.where for found in remarks)]
    if not comparison.joints:
        # It is another arm, of which no part was compared.
        parts = []
    passed = [part for part in dict.fromkeys(parts) if part not in wrong]

    suite = ET.Element(
        "testsuite",
        name=f"alpha5 compare {_printable(name)}",
        tests=str(len(failed) + len(passed)),
        failures=str(len(failed)),
        errors="0",
        skipped="0",
    )
    for found in failed:
        _add_failure(suite, name, found)
    for part in passed:
        case = _add_case(suite, name, part)
        said = [_line(found) for found in remarks if found.where == part]
        if said:
            ET.SubElement(case, "system-out").text = "\n".join(said)
    root = ET.Element("testsuites")
    root.append(suite)
    ET.indent(root)
    head = '<?xml version="1.0" encoding="utf-8"?>\n'
    return head + ET.tostring(root, encoding="unicode") + "\n"


def _add_case(suite: ET.Element, name: str, test: str) -> ET.Element:
    return ET.SubElement(
        suite, "testcase", classname=_printable(name), name=_printable(test)
    )


def _add_failure(suite: ET.Element, name: str, found: Finding) -> None:
    case = _add_case(suite, name, f"{found.where} {found.id}")
    failure = ET.SubElement(
        case, "failure", type=found.id, message=_printable(found.text)
    )
    lines = [_line(found)]
    if found.cost > 0:
        lines.append(f"gravity torque that it causes: {found.cost:.3g} N m")
    if found.instead:
        lines.append(_printable(f"write {found.instead}"))
    lines.append(f"alpha5 compare --explain {found.id}")
    failure.text = "\n".join(lines)


def _line(found: Finding) -> str:
    return _printable(f"{found.where}: {found.text} ({found.id})")


def _printable(text: str) -> str:
    """The text without characters that XML cannot hold."""
    return _NOT_XML.sub("?", text)
