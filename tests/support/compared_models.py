"""Compare the text of a model as a user does, and follow the advice of the findings."""

from __future__ import annotations

import tempfile
import xml.etree.ElementTree as ET
from collections.abc import Iterable
from pathlib import Path
from typing import Any

import damaged_models
import numpy as np
import pinocchio as pin

import alpha5_model as a5
from alpha5_model.proofs.comparison.as_arm import ArmOfModel, arm_of_model
from alpha5_model.proofs.comparison.result import Comparison

AXES = ("axis_e", "axis_d", "axis_c", "axis_b")
Source = str | bytes | ET.Element


def text_of(source: Source) -> str | bytes:
    if isinstance(source, ET.Element):
        return ET.tostring(source, encoding="unicode")
    return source


def compared(source: Source, **options: Any) -> Comparison:
    """`a5.compare` of a file with this text."""
    with tempfile.TemporaryDirectory() as folder:
        path = _written(source, folder)
        return a5.compare(path, **{"samples": 20, **options})


def described(source: Source, **options: Any) -> ArmOfModel:
    """The arm file that ``alpha5 compare --write-arm`` writes, as a record."""
    with tempfile.TemporaryDirectory() as folder:
        return arm_of_model(_written(source, folder), **options)


def _written(source: Source, folder: str) -> Path:
    """A file with this text, and with our meshes where our URDF expects them."""
    text = text_of(source)
    meshes = Path(a5.URDF_PATH).parents[1] / "meshes"
    (Path(folder) / "meshes").symlink_to(meshes)
    path = Path(folder) / "urdf" / "other.urdf"
    path.parent.mkdir()
    path.write_bytes(text if isinstance(text, bytes) else text.encode())
    return path


def advised(source: Source, comparison: Comparison) -> str:
    """The text after all that the findings say is written into it."""
    text = text_of(source)
    root = ET.fromstring(text)
    for found in comparison.findings:
        if found.id == "lint.doubled":
            for element in (*root.findall("link"), *root.findall("joint")):
                if element.get("name") == found.where:
                    _keep_the_first(element)
    text = ET.tostring(root, encoding="unicode")
    corrections = [one for found in comparison.findings for one in found.corrections]
    return damaged_models.apply(text, corrections)


def _keep_the_first(element: ET.Element) -> None:
    seen = set()
    for child in list(element):
        if child.tag in seen and child.tag not in ("visual", "collision"):
            element.remove(child)
        seen.add(child.tag)


def wheres(comparison: Comparison, serious: bool = True) -> list[str]:
    return sorted(f.where for f in comparison.findings if f.serious == serious)


def ids(comparison: Comparison) -> list[str]:
    return [found.id for found in comparison.findings]


def tools(
    text: str, q: np.ndarray, frame: str, base: str, joints: Iterable[str] = AXES
) -> list[pin.SE3]:
    """Second route: poses of a tool frame in a base frame, by Pinocchio."""
    model = pin.buildModelFromXML(text)
    data = model.createData()
    columns = [model.joints[model.getJointId(name)].idx_q for name in joints]
    poses = []
    for row in q:
        position = pin.neutral(model)
        position[columns] = row
        pin.framesForwardKinematics(model, data, position)
        at, tool = (
            data.oMf[model.getFrameId(name, pin.FrameType.BODY)]
            for name in (base, frame)
        )
        poses.append(at.inverse() * tool)
    return poses
