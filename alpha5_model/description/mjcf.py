"""MuJoCo: a folder in the style of MuJoCo Menagerie, with the buoyancy of Table 3."""

from __future__ import annotations

import xml.etree.ElementTree as ET
from collections.abc import Iterable
from dataclasses import dataclass
from pathlib import Path

from alpha5_model._support.checks import choice, flag
from alpha5_model._support.paths import REPOSITORY_PATH
from alpha5_model.collision.link_pairs import disabled_pairs
from alpha5_model.description.assets import mesh_assets, template
from alpha5_model.description.bodies import Body, arm_bodies
from alpha5_model.description.frames import own_mount, tcp_placement
from alpha5_model.description.mjcf_actuators import (
    ACTUATORS,
    add_actuators,
    add_keyframes,
)
from alpha5_model.description.mjcf_bodies import DILUTION, INERTIA, BodyWriter
from alpha5_model.description.origin import provenance
from alpha5_model.description.xml import Value, add, document, serialized
from alpha5_model.errors import InputError
from alpha5_model.geometry.collision_capsules import collision_capsules
from alpha5_model.geometry.materials import MATERIALS
from alpha5_model.numbers.corrections import DEFAULT_CORRECTIONS, check_corrections
from alpha5_model.numbers.fluids import GRAVITY, SEA_WATER, density_of
from alpha5_model.numbers.hydrodynamics import hydrodynamics
from alpha5_model.numbers.jaws import GRIPPERS, FingerJoint
from alpha5_model.numbers.motors import joint_losses
from alpha5_model.numbers.parameters import Alpha5Parameters, JointRange, chosen_arm

#: Capsules, one for each link, are for MJX.
COLLISIONS = ("primitives", "capsules", "none")
BUOYANCIES = ("bodies", "none")
#: Dynamic viscosity of sea water at 20 C for MuJoCo's drag [Pa s] [ITTC 7.5-02-01-03].
VISCOSITY = 1.08e-3

#: Of the sea bed below base_link [m].
_DEPTH = 0.6


@dataclass(frozen=True)
class MjcfOptions:
    """Options of the MuJoCo model.

    Attributes:
        gripper: ``locked`` or ``jaws``.
        fluid_density: [kg/m^3]; 0 is air. Adjustable at run time too, see the folder's
            README.
        actuators: ``position``, ``velocity`` or ``motor``.
        drag: Switches on MuJoCo's own fluid model, whose forces are not from the
            document.
        collision: ``primitives``, ``capsules`` or ``none``. One capsule stands
            for each link in MJX, which has no contact between cylinders and boxes;
            with locked jaws.
        buoyancy: ``bodies``, or ``none`` for tools without ``gravcomp``, such as brax.
        corrections: Recorded corrections to apply.
        hydrodynamics: Adds drag by strips, which is estimated, not published; instead
            of ``drag``. The strips are the catalogue's, in the frames of the links.
        arm: Record of an arm of your own, which has its corrections already; None for
            the catalogue's. Its name is the model's, and its mount is a body that
            carries ``base_link``, or the pose of ``base_link`` if the parent is
            ``world``. What is attached to a link is part of its inertial and volume.
    """

    gripper: str = "locked"
    fluid_density: float = SEA_WATER
    actuators: str = "position"
    drag: bool = False
    collision: str = "primitives"
    buoyancy: str = "bodies"
    corrections: Iterable[str] = DEFAULT_CORRECTIONS
    hydrodynamics: bool = False
    arm: Alpha5Parameters | None = None

    def __post_init__(self) -> None:
        flag("hydrodynamics", self.hydrodynamics)
        if self.drag and self.hydrodynamics:
            raise InputError("drag", self.drag, "hydrodynamics or drag, not both")
        choice("gripper", self.gripper, GRIPPERS)
        choice("actuators", self.actuators, ACTUATORS)
        choice("collision", self.collision, COLLISIONS)
        if self.collision == "capsules" and self.gripper != "locked":
            raise InputError("collision", "capsules", "primitives or none, with jaws")
        choice("buoyancy", self.buoyancy, BUOYANCIES)
        density_of(self.fluid_density)
        object.__setattr__(self, "corrections", check_corrections(self.corrections))
        chosen_arm(self.arm, self.corrections)


def mjcf_files(options: MjcfOptions | None = None) -> dict[str, bytes]:
    """The folder: path in it -> content.

    ``alpha5.xml`` (the model), ``scene.xml`` (with light and sea bed), ``assets/``
    (meshes), ``README.md``, ``CHANGELOG.md``, ``LICENSE``.

    Raises:
        Alpha5Error: See `MjcfOptions`.
    """
    chosen = options or MjcfOptions()
    arm = chosen_arm(chosen.arm, chosen.corrections)
    assets = mesh_assets(".obj")
    return {
        "alpha5.xml": mjcf(chosen, assets).encode(),
        "scene.xml": _scene(arm).encode(),
        "README.md": _readme(chosen).encode(),
        "CHANGELOG.md": template("mjcf_changelog.md").encode(),
        "LICENSE": (Path(REPOSITORY_PATH) / "LICENSE").read_bytes(),
        **{f"assets/{name}": data for name, data in assets.items()},
    }


def _scene(arm: Alpha5Parameters) -> str:
    """The model with light, and a sea bed at a depth below base_link."""
    height = 0.0 if arm.mount is None else float(arm.mount.position[2])
    sea_bed = height - _DEPTH
    return template("scene.xml").format(name=arm.name, sea_bed=sea_bed)


def _readme(options: MjcfOptions) -> str:
    moving_water = ""
    drag = "on" if options.drag else "off"
    if options.hydrodynamics:
        moving_water = template("mjcf_moving_water.md")
        drag = "estimated strips"

    source = provenance(chosen_arm(options.arm, options.corrections))
    jaws = template(f"mjcf_gripper_{options.gripper}.md").rstrip()
    words = {
        **vars(options),
        **source,
        "drag": drag,
        "moving_water": moving_water,
        "jaws": jaws,
        "inertia": INERTIA,
        "dilution": f"{DILUTION:.0e}".replace("+0", ""),
    }
    return template("mjcf_readme.md").format(**words)


def mjcf(options: MjcfOptions | None = None, meshes: Iterable[str] = ()) -> str:
    """Text of the model.

    Args:
        options: What to write.
        meshes: File names of the meshes that will be in ``assets/``; others are left
            out.
    """
    chosen = options or MjcfOptions()
    arm = chosen_arm(chosen.arm, chosen.corrections)
    bodies = arm_bodies(arm, chosen.gripper, meshes)
    joints = [body.joint for body in bodies if body.joint is not None]
    writer = BodyWriter(
        fluid_density=chosen.fluid_density,
        buoyancy=chosen.buoyancy == "bodies",
        collisions=chosen.collision == "primitives",
        capsules=collision_capsules(arm.spacer)
        if chosen.collision == "capsules"
        else {},
        water=hydrodynamics(chosen.gripper) if chosen.hydrodynamics else {},
        losses=joint_losses(arm),
    )

    root = document(arm, "mujoco", model=arm.name)
    compiler, visual, defaults = ET.fromstring(template("model.xml"))
    root.append(compiler)
    _add_option(root, chosen)
    root.append(visual)
    root.append(defaults)
    _add_assets(root, bodies)
    mount = own_mount(arm, taken=["base_link", *(body.name for body in bodies)])
    writer.add_worldbody(root, bodies, tcp_placement(arm), mount)
    if chosen.collision != "none":
        _add_contact(root, arm, chosen.gripper)
    if chosen.gripper == "jaws":
        _add_equality(root, joints)
    add_actuators(root, joints, chosen.actuators)
    add_keyframes(root, joints, chosen.actuators)
    return serialized(root)


def _add_option(root: ET.Element, options: MjcfOptions) -> None:
    """Add gravity, the integrator, and the fluid if there is drag."""
    fluid: dict[str, Value] = {}
    if options.drag:
        comment = "Density and viscosity: MuJoCo's drag, not from the document."
        root.append(ET.Comment(f" {comment} "))
        fluid = {"density": options.fluid_density, "viscosity": VISCOSITY}
    if options.hydrodynamics:
        comment = "Density: drag of the strips, estimated, not published."
        root.append(ET.Comment(f" {comment} "))
        fluid = {"density": options.fluid_density}

    # Both integrators agree if no force depends on velocity, and brax has only Euler.
    no_damping = options.actuators == "motor" and not fluid
    integrator = "Euler" if no_damping else "implicitfast"
    add(root, "option", integrator=integrator, gravity=GRAVITY, **fluid)


def _add_assets(root: ET.Element, bodies: Iterable[Body]) -> None:
    asset = add(root, "asset")
    for material in MATERIALS:
        add(asset, "material", **vars(material))
    for body in bodies:
        for mesh in body.meshes:
            add(asset, "mesh", name=mesh, file=f"{mesh}.obj")


def _add_contact(root: ET.Element, arm: Alpha5Parameters, gripper: str) -> None:
    """Pairs of bodies whose contact is not checked."""
    contact = add(root, "contact")
    for pairs in disabled_pairs(arm, gripper).values():
        for one, other in pairs:
            add(contact, "exclude", body1=one, body2=other)


def _add_equality(root: ET.Element, joints: Iterable[JointRange]) -> None:
    """Let the fingers follow the rod."""
    equality = add(root, "equality")
    for joint in joints:
        if isinstance(joint, FingerJoint):
            add(
                equality,
                "joint",
                joint1=joint.name,
                joint2=joint.leader,
                polycoef=(joint.offset, joint.multiplier, 0.0, 0.0, 0.0),
                # With MuJoCo's default, which is softer, servo and fingers excite each
                # other.
                solref="0.005 1",
            )
