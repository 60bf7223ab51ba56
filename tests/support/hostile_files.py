"""Hostile files: URDFs, xacro files, recordings, bags and studies of a stranger.

``SECRET`` in a text is replaced by the path of a file that must not be read, ``CANARY``
by the path of a file that must not be made.
"""

from __future__ import annotations

import bz2
import sqlite3
import struct
from pathlib import Path

from bag_writer import State, write_bag
from urdf_edits import OWN, with_mass

SPACE = 'xmlns:xacro="http://www.ros.org/wiki/xacro"'
JOINTS = [f"axis_{x}" for x in "edcb"]
ROWS = "".join(f"{k * 0.05:.2f},{3 + 0.01 * k},1.{k:02d},1,0.5\n" for k in range(40))
HEADER = "time_secs," + ",".join(f"{joint}_pos" for joint in JOINTS)
RECORDING = f"{HEADER}\n{ROWS}"

#: Programs in the words of xacro, Python, shells, YAML and spreadsheets.
PROGRAMS = {
    "subclasses": (
        "${(lambda: [c for c in ().__class__.__base__.__subclasses__() "
        "if c.__name__ == '_wrap_close'][0]"
        ".__init__.__globals__['system']('touch CANARY'))()}"
    ),
    "eval": "$(eval __import__('os').system('touch CANARY'))",
    "open": "${open('CANARY', 'w').write('x')}",
    "load_yaml": "${xacro.load_yaml('SECRET')}",
    "old load_yaml": "${load_yaml('SECRET')}",
    "environment": "$(env ALPHA5_TEST_SECRET)",
    "optional environment": "$(optenv ALPHA5_TEST_SECRET x)",
    "find": "$(find pkg)/SECRET",
    "shell": "$(touch CANARY)`touch CANARY`; touch CANARY",
    "format": "{0.__class__} %(x)s %n%n%n",
    "yaml": "!!python/object/apply:os.system ['touch CANARY']",
    "spreadsheet": "=cmd|'/c touch CANARY'!A1",
}
#: Places of other files, in the words of ROS, Gazebo, browsers and shells.
ADDRESSES = {
    "package": "package://../../SECRET",
    "own package": "package://pkg/SECRET",
    "file": "file://SECRET",
    "model": "model://SECRET",
    "absolute": "SECRET",
    "upwards": "../outside/SECRET_NAME",
    "beside": "SECRET_NAME",
    "web": "http://127.0.0.1:9/SECRET_NAME",
}


def with_name(text: str) -> str:
    """Our arm with a text as a name, where the text can stand in XML."""
    safe = text.replace("&", "&amp;").replace('"', "&quot;").replace("<", "&lt;")
    return OWN.replace("</robot>", f'<link name="{safe}"/></robot>').replace(
        'name="alpha5"', f'name="{safe}"', 1
    )


def with_mesh(address: str) -> str:
    """Our arm with every mesh at an address."""
    first = '<visual><geometry><mesh filename="ADDRESS"/></geometry></visual>'
    text = OWN.replace('<link name="link_2">', '<link name="link_2">' + first * 2, 1)
    for line in OWN.split("filename=")[1:]:
        name = line.split('"')[1]
        text = text.replace(f'"{name}"', '"ADDRESS"')
    return text.replace("ADDRESS", address)


def _chain(length: int) -> str:
    limit = '<limit lower="-1" upper="1" effort="1" velocity="1"/>'
    joints = "".join(
        f'<link name="l{k + 1}"/><joint name="j{k}" type="revolute">'
        f'<origin xyz="0 0 0.1"/><parent link="l{k}"/><child link="l{k + 1}"/>'
        f'<axis xyz="{k % 2} 0 1"/>{limit}</joint>'
        for k in range(length)
    )
    return f'<robot name="x"><link name="l0"/>{joints}</robot>'


def _loop() -> str:
    ends = (("a", "b"), ("b", "c"), ("c", "a"))
    joints = "".join(
        f'<joint name="{x}{y}" type="fixed">'
        f'<parent link="{x}"/><child link="{y}"/></joint>'
        for x, y in ends
    )
    links = '<link name="a"/><link name="b"/><link name="c"/>'
    return f'<robot name="x">{links}{joints}</robot>'


ENTITIES = "".join(f'<!ENTITY e{k} "{f"&e{k - 1};" * 10}">' for k in range(1, 12))
URDFS = {
    **{f"program {name}": with_name(text) for name, text in PROGRAMS.items()},
    **{f"mesh {name}": with_mesh(text) for name, text in ADDRESSES.items()},
    "include": OWN.replace(
        "</robot>", '<xacro:include filename="SECRET"/></robot>'
    ).replace("<robot ", f"<robot {SPACE} ", 1),
    "xinclude": OWN.replace(
        "</robot>",
        '<xi:include xmlns:xi="http://www.w3.org/2001/XInclude" '
        'href="SECRET" parse="text"/></robot>',
    ),
    "style sheet": '<?xml-stylesheet type="text/xsl" href="SECRET"?>'
    + OWN.partition("?>")[2],
    "external entity": (
        '<!DOCTYPE robot [<!ENTITY x SYSTEM "file://SECRET">]><robot name="&x;"/>'
    ),
    "entity in text": (
        '<!DOCTYPE robot [<!ENTITY x SYSTEM "SECRET">]><robot name="a">&x;</robot>'
    ),
    "parameter entity": (
        '<!DOCTYPE robot [<!ENTITY % x SYSTEM "file://SECRET"> %x;]><robot/>'
    ),
    "external subset": (
        '<!DOCTYPE robot SYSTEM "file://SECRET"><robot><link name="a"/></robot>'
    ),
    "entity bomb": (
        f'<!DOCTYPE robot [<!ENTITY e0 "ha">{ENTITIES}]><robot name="&e11;"/>'
    ),
    "entity loop": (
        '<!DOCTYPE robot [<!ENTITY a "&b;"><!ENTITY b "&a;">]><robot name="&a;"/>'
    ),
    "comments": "<!--" * 20_000,
    "comments in a robot": "<robot>" + "<!-- " * 16_000,
    "open comments": "<robot>" + "<!-- x -->" * 8_000,
    "brackets": "<" * 100_000,
    "instructions": "<?x " * 25_000,
    "data": "<robot><![CDATA[" + "]" * 100_000,
    "levels": "<robot>" * 14_000,
    "attributes": "<robot " + " ".join(f"a{k}=''" for k in range(20_000)) + "/>",
    "attribute": f'<robot name="{"a" * 100_000}"><link name="b"/></robot>',
    "number": with_mass(OWN, "9" * 100_000),
    "digits": with_mass(OWN, f"0.{'0' * 100_000}38"),
    "power": OWN.replace('rpy="0.0 0.0 0.0"', f'rpy="0e{"9" * 50_000} 0 0"'),
    "joints": _chain(700),
    "more joints": _chain(5000),
    "same name": '<robot name="x">' + '<link name="a"/>' * 6_000 + "</robot>",
    "loop": _loop(),
    "infinite": with_mass(OWN, "inf"),
    "not a number": OWN.replace('xyz="', 'xyz="nan ', 3),
    "huge": with_mass(OWN, "1e308"),
    "screen": with_name("\x9b31m\x9d0;title\x9c\u202e\u2066"),
    "empty": "",
    "nothing": "\0" * 100_000,
    "no text": "\ufffe" * 1000,
    "wide": OWN.encode("utf-16").decode("latin-1"),
    "binary": "".join(map(chr, range(256))) * 400,
}
#: The command may compare these files; it refuses all others.
ANSWERED = {
    *(f"program {name}" for name in PROGRAMS),
    *(f"mesh {name}" for name in ADDRESSES),
    *(f"cell {name}" for name in PROGRAMS),  # one bad row of a recording
    "include",
    "xinclude",
    "style sheet",
    "joints",
    "more joints",
    "attribute",
    "screen",
    "wide",
    "digits",
    "power",
    "columns with rows",
    "numbers",
}
XACROS = {
    **{
        f"program {name}": f'<robot name="x" {SPACE}><link name="a"/>'
        f'<xacro:property name="p" value="{text}"/><link name="${{p}}"/></robot>'
        for name, text in PROGRAMS.items()
        if '"' not in text
    },
    "include": f'<robot name="x" {SPACE}><xacro:include filename="SECRET"/></robot>',
    "recursion": (
        f'<robot name="x" {SPACE}>'
        '<xacro:macro name="m"><xacro:m/></xacro:macro><xacro:m/></robot>'
    ),
    "power": f'<robot name="x" {SPACE}><link name="${{9**9**9}}"/></robot>',
    "own": OWN,
}
RECORDINGS = {
    **{f"program {name}": f'"{text}",{HEADER}\n' for name, text in PROGRAMS.items()},
    **{
        f"cell {name}": RECORDING.replace("3.05", text.replace(",", ";"))
        for name, text in PROGRAMS.items()
    },
    "columns": ",".join([HEADER, *(f"c{k}" for k in range(60_000))]) + "\n",
    "columns with rows": ",".join([HEADER, *(f"c{k}" for k in range(20_000))])
    + "\n"
    + "".join(f"{k},1,1,1,1{',0' * 20_000}\n" for k in range(6)),
    "doubled columns": "a," * 50_000,
    "commas": "," * 100_000,
    "quotes": HEADER + "\n" + '"' * 100_000,
    "quote": HEADER + '\n"' + "1,2\n" * 25_000,
    "lines": HEADER + "\n" * 100_000,
    "line": HEADER + "\n" + "1," * 50_000,
    "cell": HEADER + "\n" + "9" * 200_000 + ",1,1,1,1\n",
    "digits": HEADER + "\n" + f"0,1,1,1,0.{'0' * 100_000}1\n" * 1,
    "powers": HEADER + "\n" + "".join(f"{k},1e{'9' * 3000},1,1,1\n" for k in range(30)),
    "names": ",".join(f"{x}_axis_{y}" for x in "abcdefghij" * 500 for y in "edcb")
    + "\n",
    "name": "tau_" * 25_000 + "axis_e\n",
    "times": HEADER + "\n" + "".join(f"{k % 7}e300,1,1,1,1\n" for k in range(4000)),
    "zero": RECORDING.replace("1", "\0"),
    "wide": RECORDING.encode("utf-16").decode("latin-1"),
    "screen": f"\x1b[31m\x1b]0;title\x07\x9b1m,{HEADER}\n" + "x" * 50,
    "screen name": f"time_secs,axis_e_pos\x1b[31m,\x1b]0;x\x07\n{ROWS}",
    "torques": RECORDING.replace("axis", "tau_axis"),
    "binary": "".join(map(chr, range(256))) * 400,
    "empty": "",
}
STUDY = """
samples = 5
[axes]
axis_e_pos = {random = [0, 3]}
axis_d_pos = 0.5
axis_c_pos = 0.5
axis_b_pos = 0.5
[outputs.peak]
quantity = "torque"
as = "peak"
"""
STUDIES = {
    **{
        f"program {name}": STUDY.replace("0.5", repr(text), 1)
        for name, text in PROGRAMS.items()
        if "'" not in text
    },
    "name": STUDY.replace("outputs.peak", "outputs.'../../CANARY_NAME'"),
    "brackets": "a = " + "[" * 50_000,
    "braces": "a = " + "{a = " * 20_000,
    "keys": "a." * 30_000 + "b = 1",
    "tables": "".join(f"[a{k}]\n" for k in range(10_000)),
    "quotes": 'a = """' + "\\\n" * 40_000,
    "count": STUDY.replace("0.5", "{from = 0, to = 1, count = 1000000000000}", 1),
    "numbers": STUDY.replace("0.5", f"[{'1,' * 40_000}]", 1),
    "digits": STUDY.replace("0.5", "9" * 5_000, 1),
    "date": STUDY.replace("0.5", "1979-05-27T07:32:00", 1),
    "yaml": "!!python/object/apply:os.system ['touch CANARY']",
    "json": '{"a": ' * 10_000,
    "binary": "".join(map(chr, range(256))) * 400,
    "empty": "",
}


def bags(folder: Path, secret: Path, canary: Path) -> dict[str, Path]:
    """Name -> a bag, written into the folder."""
    made: dict[str, Path] = {}

    def file(name: str, content: bytes, suffix: str) -> None:
        made[name] = folder / f"{name.replace(' ', '_')}{suffix}"
        made[name].write_bytes(content)

    def states() -> list[State]:
        return [
            State(10**18 + k * 10**8, JOINTS, (1.0, 1.0, 1.0, 0.5)) for k in range(8)
        ]

    for kind in (".bag", ".mcap", ".db3"):
        (folder / f"good{kind}").mkdir()
        good = write_bag(folder / f"good{kind}", kind, states()).read_bytes()
        file(f"cut {kind}", good[: len(good) // 2], kind)
        file(f"noise {kind}", good[:64] + bytes(range(256)) * 300, kind)
        file(f"text {kind}", b"tau_axis_e\n" * 5000, kind)
        file(f"empty {kind}", b"", kind)
    file(
        "lengths .mcap", b"\x89MCAP0\r\n" + b"\x01" + b"\xff" * 8 + b"x" * 1000, ".mcap"
    )
    file("lengths .bag", b"#ROSBAG V2.0\n" + b"\xff\xff\xff\x7f" * 1000, ".bag")
    file("compressed .bag", _bz2_bomb(), ".bag")
    made |= _databases(folder)
    made |= _folders(folder, secret, canary)
    return made


def _bz2_bomb() -> bytes:
    """A ROS 1 bag whose chunk expands to 200 MB."""

    def record(fields: dict[str, bytes], content: bytes) -> bytes:
        head = b"".join(
            struct.pack("<I", len(k) + 1 + len(v)) + k.encode() + b"=" + v
            for k, v in fields.items()
        )
        return (
            struct.pack("<I", len(head))
            + head
            + struct.pack("<I", len(content))
            + content
        )

    packed = bz2.compress(bytes(200_000_000), 9)
    size = struct.pack("<I", 200_000_000)
    chunk = record({"op": b"\x05", "compression": b"bz2", "size": size}, packed)
    where = struct.pack("<Q", 13 + 4096 + len(chunk))
    counts = {"conn_count": struct.pack("<I", 0), "chunk_count": struct.pack("<I", 1)}
    head = record({"op": b"\x03", "index_pos": where, **counts}, b"")
    padded = head[:-4] + struct.pack("<I", 4096 - len(head)) + b" " * (4096 - len(head))
    info = {
        "op": b"\x06",
        "ver": struct.pack("<I", 1),
        "chunk_pos": struct.pack("<Q", 13 + 4096),
    }
    times = {
        "start_time": bytes(8),
        "end_time": bytes(8),
        "count": struct.pack("<I", 0),
    }
    return b"#ROSBAG V2.0\n" + padded + chunk + record(info | times, b"")


def _databases(folder: Path) -> dict[str, Path]:
    """SQLite files whose tables are queries without end."""
    endless = "WITH RECURSIVE n(i) AS (SELECT 1 UNION ALL SELECT i + 1 FROM n)"
    topic = "(1, '/joint_states', 'sensor_msgs/msg/JointState', 'cdr', '')"
    kinds = {
        "endless messages": [
            "CREATE TABLE topics"
            "(id, name, type, serialization_format, offered_qos_profiles)",
            f"INSERT INTO topics VALUES {topic}",
            f"CREATE VIEW messages AS {endless} "
            "SELECT i AS id, 1 AS topic_id, i AS timestamp, x'00' AS data FROM n",
        ],
        "endless topics": [
            f"CREATE VIEW topics AS {endless} "
            "SELECT i AS id, '/t' || i AS name, 'sensor_msgs/msg/JointState' AS type, "
            "'cdr' AS serialization_format, '' AS offered_qos_profiles FROM n",
            "CREATE TABLE messages(id, topic_id, timestamp, data)",
        ],
    }
    made = {}
    for name, statements in kinds.items():
        made[name] = folder / f"{name.replace(' ', '_')}.db3"
        with sqlite3.connect(made[name]) as database:
            for statement in statements:
                database.execute(statement)
        database.close()
    return made


METADATA = """
rosbag2_bagfile_information:
  version: 5
  storage_identifier: mcap
  relative_file_paths: ["PATH"]
  duration: {nanoseconds: 1}
  starting_time: {nanoseconds_since_epoch: 1}
  message_count: 1
  topics_with_message_count: []
  compression_format: ""
  compression_mode: ""
  custom_data: NONE
"""


def _folders(folder: Path, secret: Path, canary: Path) -> dict[str, Path]:
    """Folders whose ``metadata.yaml`` is a program, grows or names other files."""
    program = f"!!python/object/apply:os.system ['touch {canary}']"
    bomb = "a0: &a0 [x]\n" + "".join(
        f"a{k}: &a{k} [{f'*a{k - 1},' * 10}]\n" for k in range(1, 9)
    )
    texts = {
        "yaml program": METADATA.replace("NONE", program),
        "yaml bomb": bomb + METADATA.replace("NONE", "*a8"),
        "yaml levels": METADATA.replace("NONE", "[" * 3000),
        "other mcap": METADATA.replace("PATH", f"../outside/{secret.name}.mcap"),
        "other absolute": METADATA.replace("PATH", f"{secret}.mcap"),
        "other db3": METADATA.replace("PATH", f"{secret}.db3").replace(
            "mcap\n", "sqlite3\n"
        ),
        "yaml noise": "\0" * 1000,
    }
    made = {}
    for name, text in texts.items():
        made[name] = folder / name.replace(" ", "_")
        made[name].mkdir()
        (made[name] / "metadata.yaml").write_text(text)
    return made
