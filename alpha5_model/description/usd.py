"""OpenUSD: the arm as an articulation of UsdPhysics, for Isaac Sim, Isaac Lab, Newton.

One file with bodies, joints, collision shapes and meshes. UsdPhysics has no water and
no fingers that follow a rod. Volume and centre of buoyancy of each link, and the rule
of each finger, are therefore attributes of ours, ``alpha5:...``. Masses and joint
frames are single precision there.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from alpha5_model._support.checks import FloatArray, choice
from alpha5_model._support.spatial import Placement, pose, quaternion_from_rpy
from alpha5_model.collision.link_pairs import disabled_pairs
from alpha5_model.description.assets import mesh_assets
from alpha5_model.description.bodies import Body, arm_bodies
from alpha5_model.description.digits import rounded
from alpha5_model.description.frames import own_mount, tcp_placement
from alpha5_model.description.origin import provenance
from alpha5_model.description.principal_axes import principal_axes
from alpha5_model.description.srdf import named_poses
from alpha5_model.description.urdf import COLLISIONS
from alpha5_model.description.usd_shapes import (
    add_collisions,
    add_materials,
    add_visuals,
    place,
)
from alpha5_model.errors import needing
from alpha5_model.numbers.corrections import DEFAULT_CORRECTIONS, check_corrections
from alpha5_model.numbers.jaws import GRIPPERS, FingerJoint
from alpha5_model.numbers.parameters import Alpha5Parameters, JointRange, chosen_arm

#: The pose in which the bodies stand in the file: free of collision, within limits.
START = "home"


@dataclass(frozen=True)
class UsdOptions:
    """Options of the USD file.

    Attributes:
        gripper: ``locked`` or ``jaws``.
        collision: ``primitives`` or ``none``.
        corrections: Recorded corrections to apply.
        arm: Record of an arm of your own, which has its corrections already; None for
            the catalogue's.

    Raises:
        UnknownNameError: No such gripper, collision or correction.
        InputError: An arm together with corrections that it does not have.
    """

    gripper: str = "locked"
    collision: str = "primitives"
    corrections: Iterable[str] = DEFAULT_CORRECTIONS
    arm: Alpha5Parameters | None = None

    def __post_init__(self) -> None:
        choice("gripper", self.gripper, GRIPPERS)
        choice("collision", self.collision, COLLISIONS)
        object.__setattr__(self, "corrections", check_corrections(self.corrections))
        chosen_arm(self.arm, self.corrections)


def usd_files(options: UsdOptions | None = None) -> dict[str, bytes]:
    """``alpha5.usda``: the arm with its meshes in it.

    Raises:
        Alpha5Error: See `UsdOptions`.
        MissingDependencyError: usd-core is not installed.
    """
    chosen = options or UsdOptions()
    with needing("writing USD", "pip install usd-core", "usd-core"):
        from pxr import Usd, UsdGeom, UsdPhysics

    arm = chosen_arm(chosen.arm, chosen.corrections)
    bodies = arm_bodies(arm, chosen.gripper)
    stage = Usd.Stage.CreateInMemory()
    UsdGeom.SetStageUpAxis(stage, UsdGeom.Tokens.z)
    UsdGeom.SetStageMetersPerUnit(stage, 1.0)
    UsdPhysics.SetStageKilogramsPerUnit(stage, 1.0)
    source = provenance(arm)
    stage.GetRootLayer().comment = (
        f"Generated from: {source['document']}. By: {source['package']}. "
        f"Corrections: {source['corrections']}."
    )
    writer = _Writer(stage, identifier(arm.name), chosen.collision == "primitives")
    writer.write(arm, bodies, disabled_pairs(arm, chosen.gripper))
    return {"alpha5.usda": stage.GetRootLayer().ExportToString().encode()}


def identifier(name: str) -> str:
    """A name as USD allows it: letters, digits and underscores."""
    letters = [c if c.isascii() and c.isalnum() else "_" for c in name]
    text = "".join(letters)
    return text if text and not text[0].isdigit() else f"_{text}"


@dataclass(frozen=True, eq=False)
class _Writer:
    """Writes the prims of one arm.

    Attributes:
        stage: Where to.
        name: Of the root prim, whose frame is base_link.
        collisions: Adds the collision shapes.
    """

    stage: Any
    name: str
    collisions: bool

    def write(
        self,
        arm: Alpha5Parameters,
        bodies: Iterable[Body],
        disabled: Mapping[str, Iterable[tuple[str, str]]],
    ) -> None:
        """Add the root, the bodies in their starting pose, and the joints."""
        from pxr import UsdGeom, UsdPhysics

        root = UsdGeom.Xform.Define(self.stage, f"/{self.name}")
        self.stage.SetDefaultPrim(root.GetPrim())
        UsdPhysics.ArticulationRootAPI.Apply(root.GetPrim())
        mount = own_mount(arm, taken=["base_link", *(body.name for body in bodies)])
        if mount is not None:
            place(root, pose(mount.xyz, mount.rpy))

        materials = self.path("materials")
        UsdGeom.Scope.Define(self.stage, materials)
        add_materials(self.stage, materials)
        meshes = mesh_assets(".obj")
        poses = starting_poses(bodies)
        for body in bodies:
            link = self._add_body(body, poses[body.name])
            add_visuals(self.stage, link, body, meshes, materials)
            if self.collisions:
                add_collisions(self.stage, link, body)

        UsdGeom.Scope.Define(self.stage, f"/{self.name}/joints")
        for body in bodies:
            self._add_joint(body)
        self._add_tcp(tcp_placement(arm))
        for pairs in disabled.values():
            for one, other in pairs:
                self._filter(one, other)

    def path(self, *names: str) -> str:
        """Path of a prim below the root."""
        return "/".join(["", self.name, *names])

    def _add_body(self, body: Body, placement: FloatArray) -> Any:
        """A rigid body: mass, centre of mass, principal moments, and its water."""
        from pxr import Gf, Sdf, UsdGeom, UsdPhysics

        link = UsdGeom.Xform.Define(self.stage, self.path(body.name))
        place(link, placement)
        prim = link.GetPrim()
        UsdPhysics.RigidBodyAPI.Apply(prim)
        mass = UsdPhysics.MassAPI.Apply(prim)
        moments, axes = principal_axes(body.inertia)
        mass.CreateMassAttr(float(body.mass))
        mass.CreateCenterOfMassAttr(Gf.Vec3f(*body.com.tolist()))
        mass.CreateDiagonalInertiaAttr(Gf.Vec3f(*moments.tolist()))
        mass.CreatePrincipalAxesAttr(Gf.Quatf(*axes))

        volume = prim.CreateAttribute("alpha5:volume", Sdf.ValueTypeNames.Double)
        volume.Set(float(body.volume))
        centre = prim.CreateAttribute(
            "alpha5:centerOfBuoyancy", Sdf.ValueTypeNames.Double3
        )
        centre.Set(Gf.Vec3d(*body.cob.tolist()))
        return link

    def _add_joint(self, body: Body) -> None:
        """The joint that carries a body; the first one is fixed in the root's frame."""
        from pxr import UsdPhysics

        joint = body.joint
        if joint is None:
            fixed = self.path("joints", "fixed_base")
            made = UsdPhysics.FixedJoint.Define(self.stage, fixed)
            self._connect(made, parent=self.path(), body=body)
            return

        path = self.path("joints", joint.name)
        turns = joint.kind == "revolute"
        kind = UsdPhysics.RevoluteJoint if turns else UsdPhysics.PrismaticJoint
        made = kind.Define(self.stage, path)
        made.CreateAxisAttr(UsdPhysics.Tokens.z)
        self._connect(made, parent=self.path(body.placement.parent), body=body)
        unit = np.degrees(1.0) if turns else 1.0
        if isinstance(joint, FingerJoint):
            self._add_leader(made.GetPrim(), joint)
        made.CreateLowerLimitAttr(float(joint.lower * unit))
        made.CreateUpperLimitAttr(float(joint.upper * unit))
        drive = UsdPhysics.DriveAPI.Apply(
            made.GetPrim(), "angular" if turns else "linear"
        )
        drive.CreateTypeAttr("force")
        drive.CreateMaxForceAttr(float(joint.effort))
        _add_speed_limit(made.GetPrim(), float(joint.velocity * unit))

    def _connect(self, joint: Any, parent: str, body: Body) -> None:
        """Both ends of a joint: its frame in the parent is the body's own at zero."""
        from pxr import Gf

        placement = body.placement
        x, y, z, w = rounded(quaternion_from_rpy(placement.rpy)).tolist()
        joint.CreateBody0Rel().SetTargets([parent])
        joint.CreateBody1Rel().SetTargets([self.path(body.name)])
        joint.CreateLocalPos0Attr(Gf.Vec3f(*placement.xyz))
        joint.CreateLocalRot0Attr(Gf.Quatf(w, x, y, z))
        joint.CreateLocalPos1Attr(Gf.Vec3f(0.0))
        joint.CreateLocalRot1Attr(Gf.Quatf(1.0))

    def _add_leader(self, prim: Any, joint: FingerJoint) -> None:
        """The rule by which a finger follows the rod, for whoever drives it.

        UsdPhysics has no such joints. Newton's schema has, but none that turns with one
        that slides.
        """
        from pxr import Sdf

        leader = prim.CreateRelationship("alpha5:leader")
        leader.SetTargets([self.path("joints", joint.leader)])
        kind = Sdf.ValueTypeNames.Double
        prim.CreateAttribute("alpha5:multiplier", kind).Set(float(joint.multiplier))
        prim.CreateAttribute("alpha5:offset", kind).Set(float(joint.offset))

    def _add_tcp(self, placement: Placement) -> None:
        """The tool point, a frame without mass in link_4."""
        from pxr import UsdGeom

        tcp = UsdGeom.Xform.Define(self.stage, self.path(placement.parent, "tcp"))
        place(tcp, pose(placement.xyz, placement.rpy))

    def _filter(self, one: str, other: str) -> None:
        """Two bodies whose contact is not checked."""
        from pxr import UsdPhysics

        first = self.stage.GetPrimAtPath(self.path(one))
        second = self.stage.GetPrimAtPath(self.path(other))
        if first and second:
            filtered = UsdPhysics.FilteredPairsAPI.Apply(first)
            filtered.CreateFilteredPairsRel().AddTarget(second.GetPath())


def starting_poses(bodies: Iterable[Body]) -> dict[str, FloatArray]:
    """Body -> its pose in base_link at `START`, jaws closed, (4, 4)."""
    joints = [body.joint for body in bodies if body.joint is not None]
    values = {joint.name: joint.lower for joint in joints}
    values |= zip(values, named_poses(joints)[START], strict=False)
    poses = {"base_link": np.eye(4)}
    for body in bodies:
        placement = body.placement
        at_zero = pose(placement.xyz, placement.rpy)
        moved = np.eye(4)
        if body.joint is not None:
            moved = _joint_motion(body.joint, values[body.joint.name])
        poses[body.name] = poses[placement.parent] @ at_zero @ moved
    return poses


def _joint_motion(joint: JointRange, value: float) -> FloatArray:
    """The motion of a joint about or along z, (4, 4)."""
    if joint.kind == "revolute":
        return pose((0.0, 0.0, 0.0), (0.0, 0.0, value))
    return pose((0.0, 0.0, value), (0.0, 0.0, 0.0))


def _add_speed_limit(prim: Any, speed: float) -> None:
    """Rated speed [deg/s, m/s] by PhysX's schema: UsdPhysics has none."""
    from pxr import Sdf

    prim.AddAppliedSchema("PhysxJointAPI")
    limit = prim.CreateAttribute(
        "physxJoint:maxJointVelocity", Sdf.ValueTypeNames.Float
    )
    limit.Set(speed)
