"""A comparison as a JUnit report, the form of test results that CI services read."""

from __future__ import annotations

import re
import xml.etree.ElementTree as ET

from alpha5_model.numbers.tables import BODY_NAMES
from alpha5_model.proofs.comparison.model import AXES
from alpha5_model.proofs.comparison.result import Comparison

#: Characters that XML cannot hold.
_NOT_XML = "[^\t\n\r\x20-\ud7ff\ue000-\ufffd\U00010000-\U0010ffff]"


def junit_report(comparison: Comparison, name: str) -> str:
    """The text of the report.

    Each serious finding is a test that failed, and each link, joint, base and tool
    without one is a test that passed. Remarks are printed in the test of their place.

    Args:
        comparison: What was found.
        name: Of the test suite, such as the file's.
    """
    suite = ET.Element("testsuite", name=_printable(f"alpha5 compare {name}"))
    remarks: dict[str, list[str]] = {}
    if comparison.joints:  # of another arm, no part was compared
        remarks = {part: [] for part in (*BODY_NAMES, *AXES, "base", "tool")}
    for found in comparison.findings:
        line = f"{found.where}: {found.text} ({found.id})"
        if not found.serious:
            remarks.setdefault(found.where, []).append(line)
            continue
        case = ET.SubElement(
            suite,
            "testcase",
            classname=_printable(name),
            name=_printable(f"{found.where} {found.id}"),
        )
        message = _printable(found.text)
        failure = ET.SubElement(case, "failure", type=found.id, message=message)
        advice = f"write {found.instead}" if found.instead else ""
        explain = f"alpha5 compare --explain {found.id}"
        failure.text = _printable("\n".join(filter(None, [line, advice, explain])))

    failures = len(suite)
    wrong = {found.where for found in comparison.findings if found.serious}
    for part, lines in remarks.items():
        if part in wrong:
            continue
        case = ET.SubElement(
            suite, "testcase", classname=_printable(name), name=_printable(part)
        )
        if lines:
            ET.SubElement(case, "system-out").text = _printable("\n".join(lines))
    suite.attrib |= {"tests": str(len(suite)), "failures": str(failures)}
    ET.indent(suite)
    head = '<?xml version="1.0" encoding="utf-8"?>\n'
    body = ET.tostring(suite, encoding="unicode")
    return f"{head}<testsuites>\n{body}\n</testsuites>\n"


def _printable(text: str) -> str:
    """The text without characters that XML cannot hold."""
    return re.sub(_NOT_XML, "?", text)
