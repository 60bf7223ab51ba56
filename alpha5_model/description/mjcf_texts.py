"""What stands beside the MuJoCo model: a scene around it, and a README with its derivation."""

from __future__ import annotations

from typing import TYPE_CHECKING

from alpha5_model.description.bodies import provenance
from alpha5_model.parameters import parameters

if TYPE_CHECKING:
    from alpha5_model.description.mjcf import MjcfOptions

#: Light, a sea bed below the arm's reach, a camera angle.
SCENE = """\
<mujoco model="alpha5 scene">
  <include file="alpha5.xml"/>
  <statistic center="0.1 0 0.05" extent="0.5"/>
  <visual>
    <headlight diffuse="0.6 0.6 0.6" ambient="0.3 0.35 0.4" specular="0 0 0"/>
    <rgba haze="0.05 0.2 0.3 1"/>
    <global azimuth="130" elevation="-20"/>
  </visual>
  <asset>
    <texture type="skybox" builtin="gradient" rgb1="0.1 0.4 0.5" rgb2="0 0.05 0.1" width="512" height="3072"/>
    <texture name="sea_bed" type="2d" builtin="checker" rgb1="0.5 0.45 0.35" rgb2="0.45 0.4 0.3" width="300" height="300"/>
    <material name="sea_bed" texture="sea_bed" texuniform="true" texrepeat="5 5"/>
  </asset>
  <worldbody>
    <light pos="0 0 1.5" dir="0 0 -1" directional="true"/>
    <geom name="sea_bed" type="plane" pos="0 0 -0.6" size="0 0 0.05" material="sea_bed"/>
  </worldbody>
</mujoco>
"""

_TEXT = """\
# Reach Alpha 5, MuJoCo model

Needs MuJoCo 3.5 or later. Generated from {document}
by {package}. Recorded corrections to the document: {corrections}.
Gripper: {gripper}. Fluid density: {density} kg/m^3. Actuators: {actuators}. Drag: {drag}.

## Derivation

1. Joint placements are the rows of Table 1. `eulerseq="XYZ"` reads the URDF's roll, pitch and yaw
   without a change; every number is written with all its digits.
2. `inertial` is Table 2: centre of mass, and the tensor at the centre of mass with the products of
   inertia negated, because the table has the SolidWorks sign. It is written as principal moments and axes:
   MuJoCo 3.5 finds these from a full tensor with an error of 4e-10 kg m^2.
3. Each `<link>_buoyancy` body sits at the centre of buoyancy of Table 3. Its mass is the printed volume
   over {dilution:.0e} m^3/kg, its inertia zero; `gravcomp` turns that mass into the weight of the displaced
   fluid, pointing up. Together these bodies change the mass matrix by less than 1e-13 kg m^2.
4. Joint ranges are those that the arm itself reports; `forcerange` is a placeholder that every public
   model of this arm copies, no rating is published.
5. {jaws}

## Another fluid at run time

```python
rho = 1000.0  # kg/m^3: fresh water; 1025.0 is sea water, 0.0 is air
for i in range(model.nbody):
    if model.body(i).name.endswith("_buoyancy"):
        model.body_gravcomp[i] = rho * {dilution:.0e} + 1
```

It sets the fluid whatever it was before, so the same lines with another `rho` undo it.

## MJX

The model works in MJX; write it with `--collision none`, because MJX does not know contacts between cylinders
and boxes.

## Not from the document

- Servo gains (`kp`, `kv`) are tuned to hold the arm within 0.02 rad under water, nothing more. A velocity
  servo is a position servo whose target moves (`intvelocity`), because a plain one sags under weight.
- Friction, damping and rotor inertia are absent: the document gives no rotor inertia, and its friction
  belongs to the motor shaft (Table 4).
- Drag, where it is on, is MuJoCo's inertia-box model. MuJoCo has no added mass that acts on
  accelerations.

Licence: BSD-3-Clause. The numbers are the manufacturer's.
"""
_JAWS = {
    "locked": "The jaws are closed and part of link_4, as in Table 2.",
    "jaws": (
        "Rod and fingers are taken out of link_4 so that the sum with closed jaws is Table 2's; their\n"
        "   own masses are estimates. `equality` makes the fingers follow the rod, axis_a."
    ),
}


def mjcf_readme(options: MjcfOptions, dilution: float) -> str:
    """Text of the README for these options."""
    return _TEXT.format(
        **provenance(parameters(options.corrections)),
        gripper=options.gripper,
        density=options.fluid_density,
        actuators=options.actuators,
        drag="on" if options.drag else "off",
        dilution=dilution,
        jaws=_JAWS[options.gripper],
    )
