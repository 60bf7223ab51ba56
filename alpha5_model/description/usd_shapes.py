"""What is seen of a link in USD, and the shapes with which it collides."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any, NamedTuple

import numpy as np

from alpha5_model._support.checks import FloatArray
from alpha5_model._support.spatial import pose
from alpha5_model.description.bodies import Body
from alpha5_model.description.digits import quaternion, rounded
from alpha5_model.geometry.materials import MATERIALS, linear_light, material_of
from alpha5_model.geometry.primitives import Primitive


class Triangles(NamedTuple):
    """A mesh as its OBJ has it.

    Attributes:
        points: (V, 3) [m].
        corners: Point of each corner of each triangle, (F, 3).
        normals: Of each corner, (F, 3, 3).
    """

    points: FloatArray
    corners: FloatArray
    normals: FloatArray


def triangles(obj: bytes) -> Triangles:
    """The triangles of one of our own OBJ files, which name a normal at each corner."""
    points = []
    normals = []
    corners = []
    for line in obj.decode("ascii").splitlines():
        word, *values = line.split()
        if word == "v":
            points.append([float(value) for value in values])
        elif word == "vn":
            normals.append([float(value) for value in values])
        elif word == "f":
            corners.append([value.split("//") for value in values])
    # OBJ counts from 1.
    indices = np.array(corners, dtype=int) - 1
    return Triangles(
        points=np.array(points),
        corners=indices[..., 0],
        normals=np.array(normals)[indices[..., 1]],
    )


def add_materials(stage: Any, scope: str) -> None:
    """The materials of the arm, by the surface that every USD renderer knows."""
    from pxr import Gf, Sdf, UsdShade

    for material in MATERIALS:
        path = f"{scope}/{material.name}"
        made = UsdShade.Material.Define(stage, path)
        surface = UsdShade.Shader.Define(stage, f"{path}/surface")
        surface.CreateIdAttr("UsdPreviewSurface")
        colour = surface.CreateInput("diffuseColor", Sdf.ValueTypeNames.Color3f)
        colour.Set(Gf.Vec3f(*map(linear_light, material.rgba[:3])))
        number = Sdf.ValueTypeNames.Float
        surface.CreateInput("metallic", number).Set(material.metallic)
        surface.CreateInput("roughness", number).Set(material.roughness)
        output = surface.CreateOutput("surface", Sdf.ValueTypeNames.Token)
        made.CreateSurfaceOutput().ConnectToSource(output)


def add_visuals(
    stage: Any, link: Any, body: Body, objects: Mapping[str, bytes], materials: str
) -> None:
    """The meshes of a body.

    Args:
        stage: Where to.
        link: The body's prim.
        body: The body.
        objects: Content of each OBJ file, by its name.
        materials: Path of the scope of `add_materials`.
    """
    from pxr import UsdGeom, UsdShade, Vt

    for name, placement in body.meshes.items():
        drawn = triangles(objects[f"{name}.obj"])
        mesh = UsdGeom.Mesh.Define(stage, f"{link.GetPath()}/visual_{name}")
        place(mesh, pose(placement.xyz, placement.rpy))
        mesh.CreatePointsAttr(Vt.Vec3fArray.FromNumpy(drawn.points.astype("f4")))
        count = len(drawn.corners)
        mesh.CreateFaceVertexCountsAttr(Vt.IntArray(count, 3))
        corners = drawn.corners.astype("i4").ravel()
        mesh.CreateFaceVertexIndicesAttr(Vt.IntArray.FromNumpy(corners))
        normals = drawn.normals.astype("f4").reshape(-1, 3)
        mesh.CreateNormalsAttr(Vt.Vec3fArray.FromNumpy(normals))
        mesh.SetNormalsInterpolation(UsdGeom.Tokens.faceVarying)
        mesh.CreateSubdivisionSchemeAttr(UsdGeom.Tokens.none)
        low, high = drawn.points.min(axis=0), drawn.points.max(axis=0)
        mesh.CreateExtentAttr(Vt.Vec3fArray.FromNumpy(np.array([low, high], "f4")))
        material = UsdShade.Material.Get(stage, f"{materials}/{material_of(name).name}")
        UsdShade.MaterialBindingAPI.Apply(mesh.GetPrim()).Bind(material)


def add_collisions(stage: Any, link: Any, body: Body) -> None:
    """The collision shapes of a body, which are not drawn."""
    from pxr import UsdGeom, UsdPhysics

    for i, shape in enumerate(body.shapes):
        made = _shape(stage, f"{link.GetPath()}/collision_{i}", shape)
        made.CreatePurposeAttr(UsdGeom.Tokens.guide)
        UsdPhysics.CollisionAPI.Apply(made.GetPrim())


def _shape(stage: Any, path: str, shape: Primitive) -> Any:
    """One shape; a box is a scaled cube of edge 1."""
    from pxr import Gf, UsdGeom

    if shape.kind == "box":
        cube = UsdGeom.Cube.Define(stage, path)
        cube.CreateSizeAttr(1.0)
        cube.CreateExtentAttr([Gf.Vec3f(-0.5), Gf.Vec3f(0.5)])
        place(cube, pose(shape.xyz, shape.rpy))
        cube.AddScaleOp().Set(Gf.Vec3f(*shape.size))
        return cube
    if shape.kind == "cylinder":
        radius, length = shape.size
        cylinder = UsdGeom.Cylinder.Define(stage, path)
        cylinder.CreateAxisAttr(UsdGeom.Tokens.z)
        cylinder.CreateRadiusAttr(radius)
        cylinder.CreateHeightAttr(length)
        corner = Gf.Vec3f(radius, radius, length / 2)
        cylinder.CreateExtentAttr([-corner, corner])
        place(cylinder, pose(shape.xyz, shape.rpy))
        return cylinder
    (radius,) = shape.size
    sphere = UsdGeom.Sphere.Define(stage, path)
    sphere.CreateRadiusAttr(radius)
    sphere.CreateExtentAttr([Gf.Vec3f(-radius), Gf.Vec3f(radius)])
    place(sphere, pose(shape.xyz, shape.rpy))
    return sphere


def place(prim: Any, placement: FloatArray) -> None:
    """Position and orientation of a prim in its parent, in double precision."""
    from pxr import Gf, UsdGeom

    prim.AddTranslateOp().Set(Gf.Vec3d(*rounded(placement[:3, 3]).tolist()))
    turn = prim.AddOrientOp(UsdGeom.XformOp.PrecisionDouble)
    turn.Set(Gf.Quatd(*quaternion(placement[:3, :3])))
