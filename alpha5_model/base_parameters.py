"""The fewest numbers that fix the torques and the load on the mount of the arm on a fixed base.

What lies on the axis of a joint, or turns about it like a ring, moves with the link before just as well: a
body's mass m, its moment m c_z and its second moment along the axis are handed down to that link [Khalil2002].
Of each moving link two first moments and the other second moments are left; link_0, which does not move, has
only weight. In a fluid the weight is less by the displaced fluid's, so its mass and moments, ``m - rho V``
and ``m c - rho V b``, are numbers of their own, which are handed down in the same way.

References:
    [Khalil2002] Khalil, Dombre: Modeling, Identification and Control of Robots, section 9.4.
    [Wensing2018] Wensing, Kim, Slotine: Linear matrix inequalities for physically consistent inertial
        parameter identification, IEEE RA-L 3(1) (second moments instead of the tensor of inertia).
"""

from __future__ import annotations

_FIRST = ("hx", "hy", "nx", "ny")
_SECOND = ("xx", "yy", "xy", "xz", "yz")
#: Name -> unit, in order. ``xx`` to ``yz`` are second moments, the integral of x x ... y z over the mass, ``hx``
#: and ``hy`` first moments of the mass, ``nx`` to ``nz`` of the net mass, ``n`` the net mass, each with what the
#: links beyond hand down, in the axes of the link. Link 1 turns about its z only and shows ``zz = xx + yy``.
BASE_PARAMETERS: dict[str, str] = {
    "link_0.n": "kg",
    **{f"link_0.{axis}": "kg m" for axis in ("nx", "ny", "nz")},
    **{f"link_1.{name}": "kg m^2" for name in ("zz", "xz", "yz")},
    **{f"link_1.{name}": "kg m" for name in _FIRST},
    **{
        f"link_{i}.{name}": unit
        for i in (2, 3, 4)
        for names, unit in ((_SECOND, "kg m^2"), (_FIRST, "kg m"))
        for name in names
    },
    **{f"gravity.{axis}": "m/s^2" for axis in "xyz"},
}
