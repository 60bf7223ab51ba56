"""Interim: no meshes yet."""

from __future__ import annotations


def mesh_files() -> dict[str, bytes]:
    return {}
