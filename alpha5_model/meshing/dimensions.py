"""The table of dimensions: one record per part, every number with its kind of source. All in mm.

A `Dimension` is a float that knows where it comes from:

- ``measured``: a fact about the arm, read off the bounds of the manufacturer's public CAD parts in the
  document's frames (the parts themselves are neither used nor copied);
- ``printed``: derived from a length of Table 1;
- ``chosen``: drawn freely after the document's Figures 1 and 7, where necessary so that the centroid
  comes to Table 3's centre of buoyancy.

The one dimension per part that follows from Table 3's volume is not in this table: `bodies` names it and
gives its range. The jaws' lengths are the supplementary values, with their status as the kind.
"""

from __future__ import annotations

from dataclasses import dataclass

from alpha5_model.errors import PublishedDataError
from alpha5_model.published import published
from alpha5_model.published.quantity import Quantity

SOURCES = ("measured", "printed", "chosen")
Points = tuple[tuple[float, float], ...]


class Dimension(float):
    """A length in mm with the kind of its source, one of `SOURCES`."""

    source: str

    def __new__(cls, value: float, source: str) -> Dimension:
        number = super().__new__(cls, value)
        number.source = source
        return number


def _printed(length: Quantity | str) -> Dimension:
    if isinstance(length, str):
        raise PublishedDataError("Table 1", f"expected a length, got {length!r}")
    return Dimension(float(length.value), "printed")


#: Every turned part has this radius.
RADIUS = Dimension(20.0, "measured")


@dataclass(frozen=True)
class BaseDimensions:
    """Link 0 in its inertial frame: hub on z, round tube along -x, capped, mounting foot on the -y side.

    Attributes:
        rear: x of the cable plug's end.
        plug_radius: Of the plug in the middle of the cap.
        cap, cap_edge: x of the tube's closed end, and its rounding.
        hub_low, hub_high: z of the hub's faces; the upper one carries link 1.
        hub_edge: Rounding of the hub's lower edge.
        tube_front: x up to which the tube is whole; from there link 1's collar turns above it.
        foot_face: y of the foot's mounting face.
        foot_rear, foot_front, foot_slope: x of the foot's end, where its flat face ends, and where its slope
            meets the tube.
        foot_edge: y where the slope ends.
        foot_half_width: Half of its width along z.
        shaft_radius, shaft_offset: Bore in the hub's upper face, under link 1, and y of its axis.
    """

    rear: Dimension = Dimension(-126.65, "measured")
    plug_radius: Dimension = Dimension(8.0, "chosen")
    cap: Dimension = Dimension(-103.0, "chosen")
    cap_edge: Dimension = Dimension(3.0, "chosen")
    hub_low: Dimension = Dimension(-20.0, "measured")
    hub_high: Dimension = Dimension(13.4, "chosen")
    hub_edge: Dimension = Dimension(6.5, "chosen")
    tube_front: Dimension = Dimension(-21.2, "chosen")
    foot_face: Dimension = Dimension(-24.0, "measured")
    foot_rear: Dimension = Dimension(-106.0, "chosen")
    foot_front: Dimension = Dimension(-62.0, "chosen")
    foot_slope: Dimension = Dimension(-44.0, "chosen")
    foot_edge: Dimension = Dimension(-19.0, "chosen")
    foot_half_width: Dimension = Dimension(19.0, "chosen")
    shaft_radius: Dimension = Dimension(15.0, "chosen")
    shaft_offset: Dimension = Dimension(3.0, "chosen")


@dataclass(frozen=True)
class ShellDimensions:
    """Links 1 and 3, the same part: a collar that goes on as a half-shell to a cheek, 20 mm off, cut at 45 deg.

    In the shell's own frame: origin on the cheek's axis, z along that axis towards the cheek, x to the
    collar's axis, y down to the collar.

    Attributes:
        axes_apart: Distance of the two axes, a_0 = a_2 of Table 1.
        shoulder: Height of link 1's cheek axis, axis d, above link 1's origin, d_0 of Table 1.
        collar_face: y of the collar's face, where it turns against its neighbour.
        floor: y of the collar's other face, inside the half-shell.
        inside: x from which the half-shell closes round link 2's barrel.
        mitre: y + z on the half-shell's free edge; link 2 meets it at the joint's limit of 195 deg.
        cheek_inner, cheek_outer: z of the cheek's faces.
        bore_shift: z of the half-shell's bore axis; thickens the wall away from the cheek.
    """

    axes_apart: Dimension
    shoulder: Dimension
    collar_face: Dimension = Dimension(32.4, "measured")
    floor: Dimension = Dimension(20.6, "chosen")
    inside: Dimension = Dimension(12.0, "chosen")
    mitre: Dimension = Dimension(0.0, "chosen")
    cheek_inner: Dimension = Dimension(14.6, "chosen")
    cheek_outer: Dimension = Dimension(20.0, "measured")
    bore_shift: Dimension = Dimension(6.0, "chosen")


@dataclass(frozen=True)
class UpperArmDimensions:
    """Link 2 in its own frame: origin on axis d, z along it, x along the motor tube.

    That frame is inertial frame {2} turned about z by -theta_c.

    Attributes:
        reach, drop: Axis c, 145.3 and 40 of Table 1's caption; the tube runs half-way between.
        mitre: x - z on the tube's end, cut at 45 deg as links 1 and 3 are; the other end mirrors it.
        neck: y up to which the tube goes on and joins the barrel.
        barrel_low, barrel_high: z of the barrels' faces; the cheeks of links 1 and 3 cover the upper.
        barrel_edge: Rounding of their lower edge.
        cheek_relief: Radius around a joint axis that is left free for a cheek to turn in.
    """

    reach: Dimension
    drop: Dimension
    mitre: Dimension = Dimension(11.2, "chosen")
    neck: Dimension = Dimension(14.0, "chosen")
    barrel_low: Dimension = Dimension(-20.0, "measured")
    barrel_high: Dimension = Dimension(14.1, "chosen")
    barrel_edge: Dimension = Dimension(6.3, "chosen")
    cheek_relief: Dimension = Dimension(20.6, "chosen")


@dataclass(frozen=True)
class WristDimensions:
    """Link 4 along -z of its frame: stepped tube with rings, then the jaw collar. Distances are positive.

    Attributes:
        tube_start: Distance of the tube's first face from the elbow axis.
        rings: Distances of the ring grooves from the elbow axis.
        waist: Distances between which the tube is thinner.
        waist_depth: By how much, in radius.
        collar_height: Height of the jaw collar above its base.
        slot_half_width, slot_depth: Slot across the collar in which the fingers turn.
        rod_radius, rod_depth: Bore on the axis in the slot's floor, where the jaw rod comes out.
        bearing_radius: Bore in the elbow's end, over link 3's collar.
    """

    tube_start: Dimension = Dimension(33.0, "measured")
    rings: tuple[float, ...] = (41.0, 46.0, 108.0, 118.0, 128.0)
    waist: tuple[float, float] = (52.0, 97.0)
    waist_depth: Dimension = Dimension(1.7, "chosen")
    collar_height: Dimension = Dimension(12.0, "measured")
    slot_half_width: Dimension = Dimension(5.6, "chosen")
    slot_depth: Dimension = Dimension(10.6, "chosen")
    rod_radius: Dimension = Dimension(7.5, "chosen")
    rod_depth: Dimension = Dimension(24.0, "chosen")
    bearing_radius: Dimension = Dimension(14.0, "chosen")


@dataclass(frozen=True)
class FingerDimensions:
    """A finger in the frame of finger_1: hinge on z, y to the tip, x to the other finger.

    Attributes:
        centre_x, centre_y: Points on the centre line, hinge to tip.
        half_widths: Half of the plate's thickness across the centre line at these points.
        width: Of the plate along the hinge, beyond the collar.
        outline: (y, half of the plate's width) from the eye around the hinge to the tip.
        corner: Radius of the outline's corners.
        lug_radius: Radius of the eye around the hinge.
        pin_radius: Radius of the hinge's hole.
        hook: How far each finger's half of the tip reaches past the middle plane.
        holes: (y, radius as a share of the largest) of the plate's holes.
    """

    centre_x: tuple[float, ...] = (0.0, -2.6, -4.2, -3.2, 1.2, 8.0, 15.6)
    centre_y: tuple[float, ...] = (0.0, 12.0, 26.0, 42.0, 57.0, 70.5, 83.2)
    half_widths: tuple[float, ...] = (4.2, 2.2, 1.8, 1.8, 1.8, 1.8, 1.8)
    width: Dimension = Dimension(32.0, "measured")
    outline: Points = ((-6.0, 5.25), (8.0, 5.25), (12.5, 16.0), (50.0, 16.0), (90.0, 5.5))
    corner: Dimension = Dimension(4.0, "chosen")
    lug_radius: Dimension = Dimension(4.4, "chosen")
    pin_radius: Dimension = Dimension(1.5, "chosen")
    hook: Dimension = Dimension(2.4, "chosen")
    holes: Points = ((26.5, 1.0), (48.5, 1.0), (67.0, 0.7))


_FIRST, _ELBOW = published().table_1.rows[0], published().elbow
BASE = BaseDimensions()
SHELL = ShellDimensions(_printed(_FIRST.a), _printed(_FIRST.d))
UPPER_ARM = UpperArmDimensions(_printed(_ELBOW.adjacent), _printed(_ELBOW.opposite))
WRIST = WristDimensions()
FINGER = FingerDimensions()
#: The jaws' lengths, named as in `alpha5_model.parameters.JawParameters`.
JAWS = {
    name: Dimension(float(jaw.quantity.value), jaw.status)
    for name, jaw in published().supplementary.jaws.items()
    if jaw.quantity.unit == "mm"
}
