"""URDF and xacro files that mean harm.

No code runs, no other file is read, and the cost grows with the size of the file.
"""

from __future__ import annotations

import contextlib
import os
import sys
import time
from collections.abc import Callable
from functools import cache
from pathlib import Path

import pytest
from urdf_edits import OWN, with_mass

import alpha5_model as a5
from alpha5_model.cli import main
from alpha5_model.description.reading import parse_urdf
from alpha5_model.description.xml_reading import parse_xml
from alpha5_model.errors import Alpha5Error, FileFormatError, InputError

NAMESPACE = "xmlns:xacro='http://www.ros.org/wiki/xacro'"
#: What a xacro file can do to its reader: it makes the file {mark} or reads {secret}.
PROGRAMS = {
    "subclasses": "${{(lambda: [c for c in ().__class__.__base__.__subclasses__() "
    "if c.__name__ == '_wrap_close'][0]"
    ".__init__.__globals__['system']('touch {mark}'))()}}",
    "substitution": "$(eval __import__('os').system('touch {mark}'))",
    "yaml": "${{xacro.load_yaml('{secret}')}}",
    "environment": "$(env ALPHA5_TEST_SECRET)",
    "include": "<xacro:include filename='{secret}'/>",
}
READERS: dict[str, Callable[[Path], object]] = {
    "compare": lambda path: a5.compare(path, samples=2),
    "urdf": lambda path: parse_urdf(path.read_bytes(), str(path)),
    "dh": a5.dh.DHChain.from_urdf,
}


@pytest.fixture
def secret(tmp_path, monkeypatch) -> Path:
    path = tmp_path / "secret.yaml"
    path.write_text("word: XYZZY")
    monkeypatch.setenv("ALPHA5_TEST_SECRET", "XYZZY")
    return path


def with_program(program: str) -> str:
    """Our own arm with a program as an element, or in an attribute."""
    inside = program
    if not program.startswith("<"):
        inside = f"<xacro:property name='x' value=\"{program}\"/>"
    text = OWN.replace('name="alpha5"', f'name="alpha5" {NAMESPACE}', 1)
    return text.replace("</robot>", f'{inside}<link name="odd"/></robot>')


@pytest.mark.parametrize("program", PROGRAMS)
@pytest.mark.parametrize("reader", READERS)
def test_no_file_is_executed(reader, program, tmp_path, secret, capfd):
    mark = tmp_path / "executed"
    text = with_program(PROGRAMS[program].format(mark=mark, secret=secret))
    number = with_mass(text, "${1 + 1}")
    for suffix, content in (
        (".urdf", text),
        (".urdf", number),
        (".xacro", text),
        (".XACRO", number),
    ):
        path = tmp_path / f"arm{suffix}"
        path.write_text(content)
        said = ""
        try:
            READERS[reader](path)
        except Alpha5Error as error:
            said = str(error)
        assert not mark.exists()
        assert "XYZZY" not in said + "".join(capfd.readouterr())
        assert len(said.splitlines()) <= 1


def test_the_programs_above_would_do_harm(tmp_path, secret):
    """Otherwise the test above could not fail."""
    mark = tmp_path / "executed"
    path = tmp_path / "arm.xacro"
    program = PROGRAMS["subclasses"].format(mark=mark, secret=secret)
    path.write_text(with_program(program).replace('"odd"', '"${x}"'))
    with contextlib.suppress(Alpha5Error):
        a5.compare(path, samples=2, xacro=True)
    assert mark.exists()


def test_a_name_with_a_dollar_is_just_a_name(tmp_path):
    """As the manufacturer's ``bravo_5_example.urdf`` has them."""
    path = tmp_path / "arm.urdf"
    path.write_text(OWN.replace('"link_2"', '"${name}_black"'))
    comparison = a5.compare(path, samples=2)
    assert comparison.agrees
    assert comparison.bodies[2].links == ("${name}_black",)


def test_a_xacro_file_is_expanded_on_request(tmp_path, capsys):
    package = tmp_path / "my arm"
    (package / "urdf").mkdir(parents=True)
    (package / "package.xml").write_text("<package><name> my_arm </name></package>")
    (package / "urdf" / "body.xacro").write_text(OWN)
    path = package / "urdf" / "arm's.urdf.xacro"
    inner = "<xacro:property name='pkg' value='my_arm'/>"
    inner += "<xacro:include filename='$(find ${pkg})/urdf/body.xacro'/>"
    path.write_text(f"<robot name='x' {NAMESPACE}>{inner}</robot>")

    words = ["compare", "--xacro", str(path)]
    assert main(["compare", str(path)]) == 2
    assert main(words) == 0
    (package / "package.xml").unlink()
    assert main(words) == 2
    assert main([*words, "--package", f"my_arm={package}"]) == 0
    assert len(capsys.readouterr().err.splitlines()) == 2


def test_options_of_xacro_need_a_xacro_file(tmp_path):
    path = tmp_path / "arm.urdf"
    path.write_text(OWN)
    for options in (
        {"xacro": True},
        {"packages": {"p": "folder"}},
        {"arguments": {"a": "1"}},
    ):
        with pytest.raises(InputError):
            a5.compare(path, **options)


# --- size, depth and other files


LIMIT = '<limit lower="-1" upper="1" effort="1" velocity="1"/>'
ENTITIES = "".join(f'<!ENTITY e{k} "{f"&e{k - 1};" * 10}">' for k in range(1, 12))
#: Files that declare a document type; the last three name another file.
DOCUMENT_TYPES = (
    f'<!DOCTYPE robot [<!ENTITY e0 "ha">{ENTITIES}]><robot name="&e11;"/>',
    '<!DOCTYPE robot [<!ENTITY x SYSTEM "{secret}">]><robot name="a">&x;</robot>',
    '<!DOCTYPE robot [<!ENTITY % x SYSTEM "{secret}"> %x;]><robot/>',
    '<!DOCTYPE robot SYSTEM "{secret}"><robot><link name="a"/></robot>',
)


def joint(name: str, parent: str, child: str, kind: str, more: str = "") -> str:
    ends = f'<parent link="{parent}"/><child link="{child}"/>{LIMIT}{more}'
    return f'<link name="{child}"/><joint name="{name}" type="{kind}">{ends}</joint>'


def chain(length: int, kind: str = "revolute", more: str = "") -> str:
    joints = [joint(f"j{k}", f"l{k}", f"l{k + 1}", kind, more) for k in range(length)]
    return f'<robot name="x"><link name="l0"/>{"".join(joints)}</robot>'


def star(length: int) -> str:
    joints = [joint(f"j{k}", "l", f"l{k}", "revolute") for k in range(length)]
    return f'<robot name="x"><link name="l"/>{"".join(joints)}</robot>'


def link_with(content: str) -> str:
    return f'<robot name="x"><link name="l">{content}</link></robot>'


def hanging(length: int, at: str) -> str:
    """Our arm with a long chain of links, each with a mass, behind one of its own."""
    body = (
        '<inertial><mass value="1e-5"/>'
        '<inertia ixx="1e-9" iyy="1e-9" izz="1e-9" ixy="0" ixz="0" iyz="0"/>'
        "</inertial>"
    )
    parts = []
    for k in range(length):
        part = joint(f"t{k}", f"t{k - 1}" if k else at, f"t{k}", "fixed")
        parts.append(part.replace("/>", f">{body}</link>", 1))
    return OWN.replace("</robot>", "".join(parts) + "</robot>")


def attributes(count: int) -> str:
    return "<robot " + " ".join(f"a{k}=''" for k in range(count)) + "/>"


SPHERE = '<collision><geometry><sphere radius="1"/></geometry></collision>'
MESH = '<visual><geometry><mesh filename="a" scale="1 1 1"/></geometry></visual>'
MASS = (
    '<inertial><origin/><origin/><mass value="1 "/>'
    '<inertia ixx="1" iyy="1" izz="1" ixy="0" ixz="0" iyz="0"/></inertial>'
)
#: What is large -> a file of such a size.
GROWING: dict[str, Callable[[int], str]] = {
    "chain": chain,
    "fixed chain": lambda n: chain(n, "fixed"),
    "mimics": lambda n: chain(n, more='<mimic joint="j0"/>'),
    "star": star,
    "shapes": lambda n: link_with(SPHERE * n),
    "meshes": lambda n: link_with(MESH * n),
    "doubled": lambda n: link_with(MASS * n),
    "origins": lambda n: link_with(f"<inertial>{'<origin/>' * n}</inertial>" + MASS),
    "attributes": attributes,
    "macros": lambda n: link_with(f'<xacro:x a="${{b}}"/>{"<x/>" * n}'),
    "blank lines": lambda n: "\n" * n + link_with(""),
    "long number": lambda n: link_with(MASS.replace('"1 "', f'"{"0" * n}1"')),
    "long name": lambda n: link_with("").replace('"l"', f'"{"l" * n}"'),
    "many numbers": lambda n: link_with(MASS.replace("/>", f' xyz="{"0 " * n}"/>', 1)),
    "comments": lambda n: "<!--" * n,
    "brackets": lambda n: "<" * n,
    "data": lambda n: "<robot><![CDATA[" + "]" * n,
}


def steps(text: str) -> int:
    """How often Python calls something while it reads a text."""
    count = 0

    def counted(*_: object) -> None:
        nonlocal count
        count += 1

    sys.setprofile(counted)
    try:
        with contextlib.suppress(Alpha5Error):
            parse_urdf(text)
    finally:
        sys.setprofile(None)
    return count


@pytest.mark.parametrize("what", GROWING)
def test_the_work_grows_with_the_file(what: str) -> None:
    small, large = GROWING[what](100), GROWING[what](400)
    assert steps(large) <= 4 * steps(small) + 100
    # What no Python does, C does: in less than a second for a megabyte.
    start = time.process_time()
    with contextlib.suppress(Alpha5Error):
        parse_xml(GROWING[what](10_000), "x")
    assert time.process_time() - start < 1.0


@cache
def large() -> dict[str, str]:
    """Name -> large files, for all readers."""
    return {
        **{what: make(3000) for what, make in GROWING.items()},
        "behind the tool": hanging(2000, "tcp"),
        "behind the base": hanging(2000, "link_0"),
        "zero to a power": OWN.replace(
            'rpy="0.0 0.0 0.0"', 'rpy="0e400 0e-400 0e99999999999999999999"'
        ),
    }


@pytest.mark.slow
@pytest.mark.parametrize("reader", READERS)
def test_large_files_end_soon(reader, tmp_path, capfd):
    path = tmp_path / "arm.urdf"
    late = {}
    for case, text in large().items():
        path.write_text(text)
        said = ""
        start = time.process_time()
        try:
            READERS[reader](path)
        except Alpha5Error as error:
            said = str(error)
        spent = time.process_time() - start
        if spent > 10.0 * max(1.0, len(text) / 1e5):
            late[case] = spent
        assert len(said.splitlines()) <= 1
    assert late == {}
    capfd.readouterr()


@pytest.mark.parametrize("text", DOCUMENT_TYPES)
def test_a_document_type_is_refused_by_its_line(text, tmp_path, secret, capfd):
    path = tmp_path / "arm.urdf"
    path.write_text("\n" + text.replace("{secret}", str(secret)))
    for read in READERS.values():
        with pytest.raises(FileFormatError) as caught:
            read(path)
        assert caught.value.place == "line 2"
        assert "XYZZY" not in str(caught.value) + "".join(capfd.readouterr())


def test_depth_and_number_have_bounds():
    deep = "<a>" * 100 + "</a>" * 100
    assert len(parse_xml(deep, "x").lines) == 100
    assert len(parse_xml(f"<b>{deep[3:-4] * 3}</b>", "x").lines) == 1 + 3 * 99
    for text in (f"<b>{deep}</b>", "<robot>" * 15_000, chain(10_001, "fixed")):
        with pytest.raises(FileFormatError):
            parse_urdf(text)


def test_a_file_beyond_the_largest_size_is_refused_unread(tmp_path):
    path = tmp_path / "arm.urdf"
    path.touch()
    os.truncate(path, 65 * 2**20)
    with pytest.raises(FileFormatError):
        parse_urdf(path.read_bytes())


@pytest.mark.parametrize("end", ["&#10;", "&#x2028;"])
@pytest.mark.parametrize(
    "old",
    [
        '<robot name="alpha5"',
        '<joint name="axis_e"',
        '<child link="link_2"',
        'filename="../meshes/link_2.obj"',
    ],
)
def test_a_name_cannot_pose_as_the_verdict(old, end, tmp_path, capsys):
    """compare prints names; one with a line end printed a line of its own."""
    assert old in OWN
    path = tmp_path / "forged.urdf"
    forged = f"{old[:-1]}{end}The model agrees with the tables."
    path.write_text(OWN.replace(old, f'{forged}"'), encoding="utf-8")
    for read in READERS.values():
        with pytest.raises(FileFormatError):
            read(path)
    assert main(["compare", str(path)]) == 2
    out, err = capsys.readouterr()
    assert out == ""
    assert len(err.splitlines()) == 1
