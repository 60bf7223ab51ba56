"""URDF of a serial arm from its standard DH table, through ``xacro/dh_chain.urdf.xacro``."""

from __future__ import annotations

import math
import tempfile
from pathlib import Path
from typing import Any

from alpha5_model.checks import FloatArray
from alpha5_model.description.expand import expand_xacro
from alpha5_model.errors import MissingParameterError
from alpha5_model.kinematics.dh import DHChain, DHLink
from alpha5_model.paths import REPOSITORY_PATH
from alpha5_model.spatial import rpy_from_rotation


def dh_chain_urdf(chain: DHChain) -> str:
    """The URDF of a DH chain: links ``base_link, frame_0, link_1, frame_1, ..., tool``.

    ``frame_j`` is DH frame {j}. Revolute joints without limits become ``continuous``.

    Raises:
        MissingParameterError: A prismatic joint, or a revolute one limited on one side only, whose
            limits are not finite: URDF needs both.
    """
    import yaml

    data = {
        "name": chain.name,
        "base": _placement(chain.base),
        "tool": _placement(chain.tool),
        "links": [_row(*pair) for pair in zip(chain.joint_names, chain.links, strict=True)],
    }
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "chain.yaml"
        path.write_text(yaml.safe_dump(data), encoding="utf-8")
        source = Path(REPOSITORY_PATH) / "xacro" / "dh_chain.urdf.xacro"
        text = expand_xacro(source, {"parameters": str(path)})
    return text.replace('<robot name="dh_chain"', f'<robot name="{_escaped(chain.name)}"', 1)


def _row(name: str, link: DHLink) -> dict[str, Any]:
    bounded = math.isfinite(link.lower) and math.isfinite(link.upper)
    continuous = link.revolute and link.lower == -math.inf and link.upper == math.inf
    if not bounded and not continuous:
        raise MissingParameterError("two finite limits", f"the URDF of joint {name}")
    theta, d = (link.offset, link.d) if link.revolute else (link.theta, link.offset)
    row: dict[str, Any] = {
        "joint": name,
        "type": "continuous" if continuous else "revolute" if link.revolute else "prismatic",
        "xyz": [0.0, 0.0, d],
        "rpy": [0.0, 0.0, theta],
        "a": link.a,
        "alpha": link.alpha,
    }
    return row if continuous else {**row, "lower": link.lower, "upper": link.upper}


def _placement(transform: FloatArray) -> dict[str, list[float]]:
    """Position and fixed-axis roll, pitch, yaw."""
    rpy = rpy_from_rotation(transform[:3, :3])
    return {"xyz": transform[:3, 3].tolist(), "rpy": list(rpy)}


def _escaped(text: str) -> str:
    from xml.sax.saxutils import escape

    return escape(text, {'"': "&quot;"})
