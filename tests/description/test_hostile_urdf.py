"""URDF and xacro files that mean harm.

No code runs, no other file is read, and none takes long.
"""

from __future__ import annotations

import contextlib
import os
import shlex
import time
from functools import cache
from pathlib import Path

import pytest
from urdf_edits import OWN, with_mass

import alpha5_model as a5
from alpha5_model.cli import main
from alpha5_model.description.reading import read_urdf
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
READERS = {
    "compare": lambda path: a5.compare(path, samples=2),
    "urdf": read_urdf,
    "dh": a5.dh.DHChain.from_urdf,
}


@pytest.fixture
def secret(tmp_path, monkeypatch) -> Path:
    path = tmp_path / "secret.yaml"
    path.write_text("word: XYZZY")
    monkeypatch.setenv("ALPHA5_TEST_SECRET", "XYZZY")
    return path


def with_program(program: str) -> str:
    """Our own arm with a program as an element, in a name and in a number."""
    inside = (
        program
        if program.startswith("<")
        else f"<xacro:property name='x' value=\"{program}\"/>"
    )
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
        (".xml", number),
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


def test_a_xacro_file_is_expanded_on_request_by_the_line_that_is_given(
    tmp_path, capsys
):
    package = tmp_path / "my arm"
    (package / "urdf").mkdir(parents=True)
    (package / "package.xml").write_text("<package><name> my_arm </name></package>")
    (package / "urdf" / "body.xacro").write_text(OWN)
    path = package / "urdf" / "arm's.urdf.xacro"
    inner = "<xacro:property name='pkg' value='my_arm'/>"
    inner += "<xacro:include filename='$(find ${pkg})/urdf/body.xacro'/>"
    path.write_text(f"<robot name='x' {NAMESPACE}>{inner}</robot>")

    assert main(["compare", str(path)]) == 2
    said = capsys.readouterr().err
    assert len(said.splitlines()) == 1
    program, *words = shlex.split(said[said.index("alpha5 compare") :])
    assert (program, words) == ("alpha5", ["compare", "--xacro", str(path)])
    assert main(words) == 0

    (package / "package.xml").unlink()
    assert main(words) == 2
    said = capsys.readouterr().err
    line = shlex.split(said[said.index("alpha5 compare") :])
    assert line[1:] == [*words, "--package", "my_arm=FOLDER"]
    assert main([*words, "--package", f"my_arm={package}"]) == 0


def test_options_of_xacro_need_a_xacro_file(tmp_path):
    path = tmp_path / "arm.urdf"
    path.write_text(OWN)
    with pytest.raises(InputError, match=r"a file whose name ends in .xacro"):
        a5.compare(path, xacro=True)
    for options in ({"packages": {"p": "folder"}}, {"arguments": {"a": "1"}}):
        with pytest.raises(InputError, match="with --xacro"):
            a5.compare(path, **options)


def test_a_urdf_with_xacro_in_it_says_so(tmp_path):
    path = tmp_path / "arm.urdf"
    path.write_text(with_mass(with_program("1"), "${1 + 1}"))
    with pytest.raises(
        FileFormatError, match=r"only a file whose name ends in \.xacro"
    ):
        a5.compare(path)


# --- size, depth and other files


LIMIT = '<limit lower="-1" upper="1" effort="1" velocity="1"/>'


def joint(
    name: str, parent: str, child: str, kind: str = "revolute", more: str = ""
) -> str:
    ends = f'<parent link="{parent}"/><child link="{child}"/>{LIMIT}{more}'
    return f'<link name="{child}"/><joint name="{name}" type="{kind}">{ends}</joint>'


def chain(length: int, kind: str = "revolute", more: str = "") -> str:
    joints = [joint(f"j{k}", f"l{k}", f"l{k + 1}", kind, more) for k in range(length)]
    return f'<robot name="x"><link name="l0"/>{"".join(joints)}</robot>'


def star(length: int) -> str:
    joints = [joint(f"j{k}", "l", f"l{k}") for k in range(length)]
    return f'<robot name="x"><link name="l"/>{"".join(joints)}</robot>'


def own_with(more: str) -> str:
    return OWN.replace("</robot>", more + "</robot>")


def hanging(length: int, at: str, kind: str) -> str:
    """Our arm with a long chain behind one of its links, each link with a mass."""
    body = (
        '<inertial><mass value="1e-5"/>'
        '<inertia ixx="1e-9" iyy="1e-9" izz="1e-9" ixy="0" ixz="0" iyz="0"/>'
        "</inertial>"
    )
    parts = []
    for k in range(length):
        part = joint(f"t{k}", f"t{k - 1}" if k else at, f"t{k}", kind)
        parts.append(
            part.replace(f'<link name="t{k}"/>', f'<link name="t{k}">{body}</link>')
        )
    return own_with("".join(parts))


def before(length: int) -> str:
    """Our arm on the end of a long chain."""
    joints = [joint(f"j{k}", f"l{k}", f"l{k + 1}", "fixed") for k in range(length)]
    last = joint("mount", f"l{length}", "base_link", "fixed").replace(
        '<link name="base_link"/>', ""
    )
    return own_with('<link name="l0"/>' + "".join(joints) + last)


def arms(count: int) -> str:
    """Many arms of our shape on one base."""
    inner = OWN[OWN.index(">", OWN.index("<robot")) + 1 : OWN.rindex("</robot>")]
    parts = []
    for k in range(count):
        part = inner
        for word in ('name="', 'link="'):
            part = part.replace(word, f"{word}a{k}_")
        parts.append(
            part + joint(f"m{k}", "w", f"a{k}_base_link", "fixed").split("/>", 1)[1]
        )
    return f'<robot name="x"><link name="w"/>{"".join(parts)}</robot>'


ENTITIES = "".join(f'<!ENTITY e{k} "{f"&e{k - 1};" * 10}">' for k in range(1, 12))


@cache
def hostile() -> dict[str, str]:
    """Name -> content of files that make other readers slow, or fail."""
    return {
        "comments": "<!--" * 20_000,
        "comments in a robot": "<robot>" + "<!-- " * 20_000,
        "brackets": "<" * 100_000,
        "questions": "<?" * 50_000,
        "data": "<robot><![CDATA[" + "]" * 100_000,
        "nested": "<robot>" * 15_000,
        "nested links": "<robot>"
        + '<link name="a">' * 10_000
        + "</link>" * 10_000
        + "</robot>",
        "nested origin": OWN.replace(
            "<origin ", "<a>" * 20_000 + "</a>" * 20_000 + "<origin ", 1
        ),
        "entity bomb": f'<!DOCTYPE robot [<!ENTITY e0 "ha">{ENTITIES}]>'
        '<robot name="&e11;"/>',
        "external entity": '<!DOCTYPE robot [<!ENTITY x SYSTEM "{secret}">]>'
        '<robot name="a">&x;</robot>',
        "parameter entity": '<!DOCTYPE robot [<!ENTITY % x SYSTEM "{secret}"> %x;]>'
        "<robot/>",
        "external subset": '<!DOCTYPE robot SYSTEM "{secret}">'
        '<robot><link name="a"/></robot>',
        "long number": with_mass(OWN, "9" * 100_000),
        "long zero": with_mass(OWN, f"0.{'0' * 100_000}38"),
        "many numbers": OWN.replace('rpy="0.0 0.0 0.0"', f'rpy="{"0 " * 50_000}"', 1),
        "zero to a power": OWN.replace(
            'rpy="0.0 0.0 0.0"', 'rpy="0e400 0e-400 0e99999999999999999999"'
        ),
        "long power": OWN.replace('rpy="0.0 0.0 0.0"', f'rpy="0e{"9" * 5000} 0 0"'),
        "many attributes": "<robot "
        + " ".join(f"a{k}=''" for k in range(20_000))
        + "/>",
        "long name": OWN.replace('"link_2"', f'"{"l" * 100_000}"'),
        "chain of revolute joints": chain(5000),
        "chain of fixed joints": chain(5000, "fixed"),
        "chain of mimics": chain(5000, more='<mimic joint="j0"/>'),
        "chain of sliders": chain(5000, "prismatic"),
        "star": star(5000),
        "behind the tool": hanging(3000, "tcp", "fixed"),
        "behind the base": hanging(3000, "link_0", "revolute"),
        "before the arm": before(5000),
        "many arms": arms(60),
        "too many links": chain(10_001, "fixed"),
        "many shapes": OWN.replace(
            "</robot>",
            '<link name="odd">'
            + '<collision><geometry><mesh filename="a"/></geometry></collision>' * 1500
            + '</link><joint name="o" type="fixed">'
            '<parent link="link_4"/><child link="odd"/></joint>'
            "</robot>",
        ),
    }


#: What they promise: seconds for each 100 kB.
PROMISED = 2.0
#: On a busy machine; the files grow with the square of the time of a poor reader.
GENEROUS = 5


@pytest.mark.slow
@pytest.mark.parametrize("reader", READERS)
def test_it_ends_soon_and_reads_nothing_else(reader, tmp_path, secret, capfd):
    path = tmp_path / "arm.urdf"
    late = {}
    for case, content in hostile().items():
        text = content.replace("{secret}", str(secret))
        path.write_text(text)
        said = ""
        start = time.process_time()
        try:
            READERS[reader](path)
        except Alpha5Error as error:
            said = str(error)
        spent = time.process_time() - start
        if spent > GENEROUS * PROMISED * max(1.0, len(text) / 1e5):
            late[case] = spent
        assert "XYZZY" not in said + "".join(capfd.readouterr())
        assert len(said.splitlines()) <= 1
    assert late == {}


@pytest.mark.parametrize(
    "case", ["entity bomb", "external entity", "parameter entity", "external subset"]
)
def test_a_document_type_is_refused_by_its_line(case, tmp_path):
    path = tmp_path / "arm.urdf"
    path.write_text("\n" + hostile()[case])
    for read in READERS.values():
        with pytest.raises(
            FileFormatError, match=r"line 2: <!DOCTYPE robot>: .* are not read"
        ):
            read(path)


@pytest.mark.parametrize(
    ("case", "words"),
    [
        ("nested", "at most 100 levels"),
        ("nested origin", "at most 100 levels"),
        ("too many links", "at most 10000 links, got 10002"),
    ],
)
def test_the_bounds_are_said(case, words, tmp_path):
    path = tmp_path / "arm.urdf"
    path.write_text(hostile()[case])
    with pytest.raises(FileFormatError, match=words):
        a5.compare(path)


def test_a_file_beyond_the_largest_size_is_refused_unread(tmp_path):
    path = tmp_path / "arm.urdf"
    path.touch()
    os.truncate(path, 65 * 2**20)
    with pytest.raises(FileFormatError, match="expected at most 64 MiB, got 65 MiB"):
        read_urdf(path)


@pytest.mark.parametrize("end", ["&#10;", "&#x2028;"])
@pytest.mark.parametrize(
    ("old", "place"),
    [
        ('<joint name="axis_e"', "<joint name>"),
        ('<link name="link_2"', "<link name>"),
        ('<child link="link_2"', "<child link>"),
        ('filename="../meshes/link_2.obj"', "<mesh filename>"),
    ],
)
def test_a_name_cannot_pose_as_the_verdict(old, place, end, tmp_path, capsys):
    """compare prints names; one with a line end printed a line of its own."""
    start, _, name = old[:-1].rpartition('"')
    forged = f"{name}{end}The model agrees with the tables."
    path = tmp_path / "forged.urdf"
    path.write_text(OWN.replace(old, f'{start}"{forged}"'), encoding="utf-8")
    assert OWN.count(old) >= 1
    for reader in READERS.values():
        with pytest.raises(
            FileFormatError, match=r"line \d+: .* has a line end"
        ) as said:
            reader(path)
        assert place in str(said.value)
    assert main(["compare", str(path)]) == 2
    out, err = capsys.readouterr()
    assert out == ""
    assert len(err.splitlines()) == 1
