"""What `real_tools` asks of colcon, check_urdf, ROS 1 and RViz."""

from __future__ import annotations

import json
import os
import signal
import socket
import subprocess
import time
import xml.etree.ElementTree as ET
from collections.abc import Iterator
from contextlib import ExitStack, contextmanager
from dataclasses import dataclass
from pathlib import Path
from xmlrpc.client import ServerProxy

import numpy as np
import pinocchio as pin
from PIL import Image, ImageGrab

import alpha5_model as a5
from alpha5_model._support.paths import JAWS_URDF_PATH, URDF_PATH
from alpha5_model.description.srdf import NAMED_POSES
from alpha5_model.numbers.parameters import parameters

REPOSITORY = Path(__file__).resolve().parents[2]
NAME = "alpha5_description"
PUBLISHER = "/usr/lib/robot_state_publisher/robot_state_publisher"
#: Debian's own programs and Python, whatever else is on the path.
SYSTEM = {
    **os.environ,
    "PATH": "/usr/bin:/bin",
    "LIBGL_ALWAYS_SOFTWARE": "1",
    "PYTHONPATH": "",
}
#: Dark pixels in RViz's picture that are the arm; at home it has some twenty thousand.
LEAST_PIXELS = 10_000
_RVIZ = """\
Panels: []
Visualization Manager:
  Displays:
    - Class: rviz/RobotModel
      Name: RobotModel
      Robot Description: robot_description
      Enabled: true
  Global Options: {Background Color: 255; 255; 255, Fixed Frame: base_link}
  Views:
    Current:
      Class: rviz/Orbit
      Distance: 0.8
      Focal Point: {X: 0.1, Y: 0, Z: 0}
      Pitch: 0.4
      Yaw: 0.8
      Target Frame: base_link
Window Geometry:
  Width: 1024
  Height: 768
  X: 0
  Y: 0
  Hide Left Dock: true
  Hide Right Dock: true
"""


class NotThereError(Exception):
    """Why a tool cannot be run here."""


@dataclass(frozen=True)
class Result:
    """What came of a check.

    Attributes:
        text: For the table.
        difference: Largest one from what is expected.
        complaints: Of the tool, or about it; there must be none.
        version: Where Debian does not know it.
        warnings: That are no fault of the files'.
    """

    text: str
    difference: float = 0.0
    complaints: tuple[str, ...] = ()
    version: str = ""
    warnings: tuple[str, ...] = ()


@dataclass(frozen=True)
class Workspace:
    """Folders that the checks share."""

    folder: Path

    @property
    def share(self) -> Path:
        """Where colcon installs the package."""
        return self.folder / "install" / NAME / "share" / NAME

    @property
    def picture(self) -> Path:
        """Of RViz."""
        return self.folder / "rviz.png"


def build(work: Workspace) -> Result:
    """Build the repository as a ROS 2 package."""
    command = [
        "/usr/bin/colcon",
        "--log-base",
        "log",
        "build",
        "--base-paths",
        str(REPOSITORY),
    ]
    command += ["--packages-select", NAME, "--event-handlers", "console_direct+"]
    done = subprocess.run(
        command, cwd=work.folder, env=SYSTEM, capture_output=True, text=True, check=True
    )
    said = [
        line for line in (done.stdout + done.stderr).splitlines() if "arning" in line
    ]
    missing, count = [], 0
    for urdf in (work.share / "urdf").glob("*.urdf"):
        for mesh in ET.parse(urdf).getroot().iter("mesh"):
            count += 1
            package, _, path = (
                mesh.get("filename", "").removeprefix("package://").partition("/")
            )
            if package != NAME or not (work.share / path).is_file():
                missing.append(f"{urdf.name}: {mesh.get('filename')} not installed")
    complaints = (*said, *missing) if count else ("no meshes",)
    return Result(f"{count} URIs resolve", complaints=complaints)


def parse(work: Workspace) -> Result:
    """Let urdfdom print the tree of each URDF."""
    complaints, count = [], 0
    for path in (URDF_PATH, JAWS_URDF_PATH):
        done = subprocess.run(
            ["/usr/bin/check_urdf", path],
            capture_output=True,
            text=True,
            check=True,
            env=SYSTEM,
        )
        tree = [
            line
            for line in done.stdout.splitlines()
            if line.strip().startswith("child(")
        ]
        count += len(tree)
        model = pin.buildModelFromUrdf(path)
        ours = {
            frame.name for frame in model.frames if frame.type == pin.FrameType.BODY
        }
        theirs = {line.split(":")[1].strip() for line in tree}
        if (
            "Successfully Parsed XML" not in done.stdout
            or theirs | {"base_link"} != ours
        ):
            complaints.append(f"{Path(path).name}: {sorted(theirs ^ ours)}")
        complaints += done.stderr.split("\n")[:-1]
    return Result(f"{count} links below base_link", complaints=tuple(complaints))


@contextmanager
def ros(work: Workspace, urdf: str) -> Iterator[tuple[dict[str, str], Path]]:
    """A roscore with a robot_state_publisher: its environment and its log."""
    with socket.socket() as probe:
        probe.bind(("127.0.0.1", 0))
        port = probe.getsockname()[1]
    uri, log = f"http://127.0.0.1:{port}", work.folder / "robot_state_publisher.log"
    environment = {**SYSTEM, "ROS_MASTER_URI": uri, "ROS_IP": "127.0.0.1"}
    environment |= {"ROS_HOME": str(work.folder / "ros"), "HOME": str(work.folder)}
    environment |= {"ROS_PACKAGE_PATH": f"{work.share}:/usr/share"}
    with ExitStack() as stack:
        stack.enter_context(
            running(["roscore", "-p", str(port)], environment, "roscore.log")
        )
        master = ServerProxy(uri)
        for _ in range(120):
            try:
                master.setParam("/alpha5", "/robot_description", urdf)
                break
            except OSError:
                time.sleep(0.25)
        command = [PUBLISHER, "_publish_frequency:=1000"]
        stack.enter_context(running(command, environment, str(log)))
        yield environment, log


@contextmanager
def running(
    command: list[str], environment: dict[str, str], log: str
) -> Iterator[None]:
    """A program that is asked to stop at the end, and does."""
    with (Path(environment["HOME"]) / log).open("w", encoding="utf-8") as file:
        process = subprocess.Popen(
            command, env=environment, stdout=file, stderr=subprocess.STDOUT
        )
        try:
            yield
        finally:
            process.send_signal(signal.SIGINT)
            try:
                process.wait(10)
            except subprocess.TimeoutExpired:
                process.kill()
                process.wait()


def poses(
    work: Workspace,
    environment: dict[str, str],
    joints: list[str],
    q: np.ndarray,
    frames: list[str],
) -> np.ndarray:
    """Poses of the frames in base_link by tf, (N, F, 7).

    Each is a position and a quaternion (x, y, z, w).
    """
    request, answer = work.folder / "request.json", work.folder / "answer.json"
    asked = {
        "joints": joints,
        "positions": q.tolist(),
        "base": "base_link",
        "frames": frames,
    }
    request.write_text(json.dumps(asked), encoding="utf-8")
    script = str(REPOSITORY / "scripts" / "conformance" / "ros_states.py")
    subprocess.run(
        ["/usr/bin/python3", script, str(request), str(answer)],
        env=environment,
        capture_output=True,
        text=True,
        check=True,
        timeout=120,
    )
    return np.array(json.loads(answer.read_text(encoding="utf-8")))


def publish(work: Workspace, path: str = JAWS_URDF_PATH) -> Result:
    """Frames by robot_state_publisher and tf; the fingers follow by ``<mimic>``."""
    urdf, joints = Path(path).read_text(encoding="utf-8"), parameters().joints
    rng, frames = np.random.default_rng(2022), ["tcp", "finger_1", "finger_2"]
    q = rng.uniform(
        [j.lower for j in joints], [j.upper for j in joints], (100, len(joints))
    )
    with ros(work, urdf) as (environment, log):
        found = poses(work, environment, [j.name for j in joints], q, frames)
    arm, worst = a5.load(gripper="jaws"), 0.0
    for row, measured in zip(q, found, strict=True):
        for frame, pose in zip(frames, measured, strict=True):
            expected = arm.forward_kinematics(row, frame=frame).homogeneous
            worst = max(
                worst, np.abs(pin.XYZQUATToSE3(pose).homogeneous - expected).max()
            )
    said = tuple(
        line for line in log.read_text(encoding="utf-8").splitlines() if line.strip()
    )
    return Result(f"{worst:.0e}", float(worst), said)


def look(work: Workspace, path: Path | None = None) -> Result:
    """Let RViz draw the arm at home, and count what it draws."""
    urdf = (path or work.share / "urdf" / "alpha5.urdf").read_text(encoding="utf-8")
    settings = work.folder / "view.rviz"
    settings.write_text(_RVIZ, encoding="utf-8")
    home, joints = (
        np.array([NAMED_POSES["home"]]),
        [j.name for j in parameters().joints[:4]],
    )
    pixels = 0
    with ExitStack() as stack:
        environment, _ = stack.enter_context(ros(work, urdf))
        display = stack.enter_context(screen(environment))
        environment = {**environment, "DISPLAY": display, "QT_X11_NO_MITSHM": "1"}
        stack.enter_context(
            running(["rviz", "-d", str(settings)], environment, "rviz.log")
        )
        end = time.monotonic() + 120
        while pixels < LEAST_PIXELS and time.monotonic() < end:
            poses(work, environment, joints, home, ["tcp"])
            time.sleep(1)
            pixels = arm_pixels(picture := ImageGrab.grab(xdisplay=display))
        picture.save(work.picture)
    few = () if pixels >= LEAST_PIXELS else (f"fewer than {LEAST_PIXELS}",)
    return Result(f"{pixels} pixels of the arm", complaints=few)


def arm_pixels(picture: Image.Image) -> int:
    """Dark pixels within the white view, which ends before the window's own bars."""
    grey = np.asarray(picture.convert("L"))[70:730, 25:1000]
    return int((grey < 200).sum()) if (grey > 250).mean() > 0.5 else 0


@contextmanager
def screen(environment: dict[str, str]) -> Iterator[str]:
    """A virtual screen: its DISPLAY."""
    read, write = os.pipe()
    command = ["Xvfb", "-displayfd", str(write), "-screen", "0", "1024x768x24"]
    with open(os.devnull, "w") as nowhere, os.fdopen(read) as answer:  # noqa: PTH123
        process = subprocess.Popen(
            command, env=environment, stdout=nowhere, stderr=nowhere, pass_fds=(write,)
        )
        os.close(write)
        try:
            yield f":{answer.readline().strip()}"
        finally:
            process.terminate()
            process.wait()
