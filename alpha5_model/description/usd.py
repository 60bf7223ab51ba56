"""OpenUSD for Isaac Sim, Isaac Lab and Newton, with the table of the water beside it.

The URDF is converted by urdf-usd-converter [converter]_. What a URDF lacks, or what the
converter does not know, is added here: rotor inertia, the force of drives, friction in
the words of PhysX, and the pairs of links whose contact is not checked. The fingers
follow the rod by a rule that no schema has, since Newton's wants two joints of one
type; it is in attributes of ours.

.. [converter] github.com/newton-physics/urdf-usd-converter
"""

from __future__ import annotations

import math
import tempfile
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from alpha5_model.collision.link_pairs import disabled_pairs
from alpha5_model.description.assets import mesh_assets
from alpha5_model.description.bodies import arm_bodies
from alpha5_model.description.options import MountedOptions
from alpha5_model.description.urdf import Variant, urdf
from alpha5_model.description.water_table import WaterOptions, water_files
from alpha5_model.description.xml import provenance
from alpha5_model.errors import needing
from alpha5_model.numbers.fluids import SEA_WATER
from alpha5_model.numbers.jaws import FingerJoint, Gripper
from alpha5_model.numbers.motors import JointLosses, joint_losses
from alpha5_model.numbers.parameters import Alpha5Parameters, JointRange


@dataclass(frozen=True)
class UsdOptions(MountedOptions):
    """Options of the USD file and of the table of the water.

    Beside those of `MountedOptions`, whose parent is a prim:

    Attributes:
        collision: ``primitives`` or ``none``.
        fluid_density: Of the table [kg/m^3], given as for `alpha5_model.load`.

    Raises:
        Alpha5Error: See `Variant` and `WaterOptions`.
    """

    collision: str = "primitives"
    fluid_density: float = SEA_WATER

    def __post_init__(self) -> None:
        super().__post_init__()
        self.variant()
        self.water()

    def variant(self) -> Variant:
        """The URDF that is converted."""
        return Variant(
            gripper=self.gripper,
            parent=self.parent,
            xyz=self.xyz,
            rpy=self.rpy,
            mesh_prefix="meshes/",
            collision=self.collision,
            corrections=self.corrections,
            arm=self.arm,
        )

    def water(self) -> WaterOptions:
        """The table of the water."""
        return WaterOptions(
            gripper=self.gripper,
            fluid_density=self.fluid_density,
            corrections=self.corrections,
            arm=self.arm,
        )


def usd_files(options: UsdOptions | None = None) -> dict[str, bytes]:
    """``alpha5.usda``, the arm with its meshes in it, and ``alpha5_water.json``.

    Raises:
        Alpha5Error: See `UsdOptions`.
        MissingDependencyError: urdf-usd-converter is not installed.
    """
    chosen = options or UsdOptions()
    arm = chosen.record
    layer = _converted(urdf(chosen.variant()))
    source = provenance(arm)
    layer.documentation = (
        f"Generated from: {source['document']}. By: {source['package']}. "
        f"Corrections: {source['corrections']}."
    )
    _complete(layer, arm, chosen.gripper)
    return {
        "alpha5.usda": layer.ExportToString().encode(),
        "alpha5_water.json": water_files(chosen.water())["water.json"],
    }


def _converted(text: str) -> Any:
    """The layer that the converter makes of a URDF."""
    remedy = "pip install urdf-usd-converter, without usd-core, in Python up to 3.12"
    with needing("writing USD", remedy, "urdf-usd-converter"):
        import usdex.core  # noqa: F401
        from pxr import Sdf
        from urdf_usd_converter import Converter

    with _without_status(), tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        (folder / "meshes").mkdir()
        for mesh, content in mesh_assets(".obj", ".mtl").items():
            (folder / "meshes" / mesh).write_bytes(content)
        file = folder / "arm.urdf"
        file.write_text(text, encoding="utf-8")
        converter = Converter(layer_structure=False, scene=False)
        asset = converter.convert(str(file), str(folder / "usd"))
        layer = Sdf.Layer.CreateAnonymous(".usda")
        layer.TransferContent(Sdf.Layer.FindOrOpen(asset.path))
        return layer


@contextmanager
def _without_status() -> Iterator[None]:
    """A context in which OpenUSD prints warnings and errors, but not each step."""
    import usdex.core as usd

    was_active = usd.isDiagnosticsDelegateActive()
    level = usd.getDiagnosticsLevel()
    usd.activateDiagnosticsDelegate()
    usd.setDiagnosticsLevel(usd.DiagnosticsLevel.eWarning)
    try:
        yield
    finally:
        usd.setDiagnosticsLevel(level)
        if not was_active:
            usd.deactivateDiagnosticsDelegate()


def _complete(layer: Any, arm: Alpha5Parameters, gripper: Gripper) -> None:
    """Add what the converter does not."""
    from pxr import Usd, UsdPhysics

    stage = Usd.Stage.Open(layer)
    links = {}
    joints = {}
    for prim in stage.Traverse():
        if prim.HasAPI(UsdPhysics.RigidBodyAPI):
            links[prim.GetName()] = prim
        elif prim.IsA(UsdPhysics.Joint):
            joints[prim.GetName()] = prim

    losses = joint_losses(arm)
    for body in arm_bodies(arm, gripper):
        if body.joint is not None:
            made = joints[body.joint.name]
            _add_drive(made, body.joint, losses.get(body.joint.name))
            if isinstance(body.joint, FingerJoint):
                _add_rule(made, body.joint, joints)
    for pairs in disabled_pairs(arm, gripper).values():
        for one, other in pairs:
            if one in links and other in links:
                filtered = UsdPhysics.FilteredPairsAPI.Apply(links[one])
                filtered.CreateFilteredPairsRel().AddTarget(links[other].GetPath())


def _add_drive(prim: Any, joint: JointRange, losses: JointLosses | None) -> None:
    """Largest force and speed, rotor inertia, and friction for PhysX."""
    from pxr import Sdf, UsdPhysics

    kind = "angular" if joint.kind == "revolute" else "linear"
    drive = UsdPhysics.DriveAPI.Apply(prim, kind)
    drive.CreateTypeAttr("force")
    drive.CreateMaxForceAttr(float(joint.effort))

    prim.AddAppliedSchema("PhysxJointAPI")
    number = Sdf.ValueTypeNames.Float
    speed = prim.GetAttribute("newton:velocityLimit").Get()
    prim.CreateAttribute("physxJoint:maxJointVelocity", number).Set(speed)
    if losses is None:
        return
    for name in ("newton:armature", "physxJoint:armature"):
        prim.CreateAttribute(name, number).Set(losses.armature)
    # PhysX reads no newton:friction. This API goes before PhysxJointAPI, so it repeats
    # what that has; its numbers of turning joints are per degree, too.
    damping = losses.damping
    if kind == "angular":
        damping = math.radians(damping)
    prim.AddAppliedSchema(f"PhysxJointAxisAPI:{kind}")
    values = {
        "armature": losses.armature,
        "maxJointVelocity": speed,
        "staticFrictionEffort": losses.friction,
        "dynamicFrictionEffort": losses.friction,
        "viscousFrictionCoefficient": damping,
    }
    for name, value in values.items():
        attribute = prim.CreateAttribute(f"physxJointAxis:{kind}:{name}", number)
        attribute.Set(float(value))


def _add_rule(prim: Any, joint: FingerJoint, joints: Mapping[str, Any]) -> None:
    """The rule by which a finger follows the rod [rad, m], for whoever drives it."""
    from pxr import Sdf

    prim.RemoveAppliedSchema("NewtonMimicAPI")
    for name in prim.GetPropertyNames():
        if name.startswith("newton:mimic"):
            prim.RemoveProperty(name)
    leader = prim.CreateRelationship("alpha5:leader")
    leader.SetTargets([joints[joint.leader].GetPath()])
    number = Sdf.ValueTypeNames.Double
    prim.CreateAttribute("alpha5:multiplier", number).Set(float(joint.multiplier))
    prim.CreateAttribute("alpha5:offset", number).Set(float(joint.offset))
