"""Table 2 against itself: the two tensors of each link, the equations, mass, COM and size.

References:
    [ReachAlpha] Manufacturer's document, Section 2.1, Table 2, equations (1) and (2).
    [Wensing2018], [Bhatia2000] See `alpha5_model.inertia`.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from alpha5_model.checks import FloatArray
from alpha5_model.consistency.row import ARITHMETIC, AuditRow, judged, rounding_bound
from alpha5_model.consistency.units import GRAVITY, MM, TENSOR_UNIT, excess_of_box
from alpha5_model.inertia import (
    flip_products,
    point_mass_tensor,
    principal_moments,
    second_moments,
    tensor_at_com,
    tensor_at_origin,
)
from alpha5_model.parameters import Alpha5Parameters
from alpha5_model.published.quantity import Quantity
from alpha5_model.published.tables import InertialRow, Published
from alpha5_model.spatial import cross_matrix

_UPPER = tuple((i, j) for i in range(3) for j in range(i, 3))
_ENTRY = ("xx", "xy", "xz", "yx", "yy", "yz", "zx", "zy", "zz")
_Form = Callable[[float, FloatArray], FloatArray]


def audit(printed: Published, p: Alpha5Parameters) -> list[AuditRow]:
    """The rows of Table 2."""
    links = list(zip(printed.table_2.rows, p.links, strict=True))
    fastest = max(joint.velocity for joint in p.joints[:4])
    return [
        *(_parallel_axis(row) for row, _ in links),
        *(_product_sign(row, fastest) for row, _ in links),
        *_equations(printed.table_2.rows[4]),
        _any_frame(printed.table_2.rows[4]),
        *_rotation(printed.table_2.rows[1:], p),
        *(_implied_mass(row) for row, _ in links),
        _total_mass(printed.table_2.rows),
        *(_possible(row, name) for row, _ in links for name in ("com", "link")),
        *(_com_inside(row, link.bounds) for row, link in links),
        *(_mass_spread(row, link.bounds) for row, link in links),
        *_jaw_plane(printed),
    ]


def _inputs(row: InertialRow) -> list[Quantity]:
    """Mass, COM (3), I_COM (6) and I_Link (6) as printed."""
    tensors = (row.inertia_com, row.inertia_link)
    return [row.mass, *row.com, *(t[i][j] for t in tensors for i, j in _UPPER)]


def _read(x: FloatArray) -> tuple[float, FloatArray, FloatArray, FloatArray]:
    """Mass [kg], COM [m], I_COM and I_Link [kg m^2] in URDF sign, from SI inputs."""
    tensors = np.zeros((2, 3, 3))
    for k, (i, j) in enumerate(_UPPER):
        tensors[:, i, j] = tensors[:, j, i] = x[4 + k], x[10 + k]
    at_com, at_link = flip_products(tensors)
    return float(x[0]), x[1:4], at_com, at_link


def _residual(x: FloatArray) -> FloatArray:
    mass, com, at_com, at_link = _read(x)
    return at_link - tensor_at_origin(mass, com, at_com)


def _si(inputs: list[Quantity]) -> FloatArray:
    return np.array([q.si for q in inputs])


def _worst(residual: FloatArray, bound: FloatArray) -> tuple[int, int]:
    """The largest entry, among those beyond their bound if there are any."""
    size = np.abs(residual)
    beyond = size > bound
    k = int(np.argmax(np.where(beyond, size, 0.0) if beyond.any() else size))
    return k // 3, k % 3


def _place(row: InertialRow, more: str = "") -> str:
    return f"Section 2.1, Table 2, link {row.link}{more}"


def _parallel_axis(row: InertialRow) -> AuditRow:
    inputs = _inputs(row)
    residual, bound = _residual(_si(inputs)), rounding_bound(_residual, inputs)
    i, j = _worst(residual, bound)
    beyond = int((np.abs(residual) > bound)[np.triu_indices(3)].sum())
    return judged(
        f"parallel_axis.link_{row.link}",
        _place(row),
        "I_COM and I_Link are one tensor in two frames",
        abs(residual[i, j]) / TENSOR_UNIT,
        "=",
        0.0,
        bound[i, j] / TENSOR_UNIT,
        "kg mm^2",
        f"{beyond} of 6 entries are further apart than rounding allows"
        + f"; the largest is {_ENTRY[3 * i + j]}",
    )


def _product_sign(row: InertialRow, fastest: float) -> AuditRow:
    """The control: with the products read in URDF sign, the same residual must be out of bounds."""
    inputs = _inputs(row)

    def opposite(x: FloatArray) -> FloatArray:
        mass, com, at_com, at_link = _read(x)
        return flip_products(at_link) - tensor_at_origin(mass, com, flip_products(at_com))

    residual, bound = opposite(_si(inputs)), rounding_bound(opposite, inputs)
    i, j = _worst(residual, bound)
    off = _si(inputs)[[5, 6, 8]]
    return judged(
        f"product_sign.link_{row.link}",
        _place(row),
        "products of inertia are positive (SolidWorks)",
        abs(residual[i, j]) / TENSOR_UNIT,
        ">=",
        bound[i, j] / TENSOR_UNIT,
        0.0,
        "kg mm^2",
        "with the opposite sign the two tensors are this far apart, so the sign is settled; "
        "the effect is what a wrong sign does at the fastest joint's rated speed",
        effect=2 * np.abs(off).max() * fastest**2,
        effect_unit="N m",
    )


def _equations(row: InertialRow) -> list[AuditRow]:
    """Equations (1) and (2), as printed and as they must be, on the link with the longest lever."""
    inputs = _inputs(row)
    forms: tuple[tuple[str, str, str, _Form, str], ...] = (
        (
            "equation_1.printed",
            "equation (1)",
            "I_Link = I_COM + m[(P.P)E - (P.P)^T]",
            lambda m, p: m * ((p @ p) * np.eye(3) - np.transpose(p @ p) * np.eye(3)),
            "(P.P)^T is a number where a matrix must stand; read as (P.P) E the term vanishes",
        ),
        (
            "equation_1.corrected",
            "equation (1)",
            "the same with the outer product P P^T",
            lambda m, p: m * ((p @ p) * np.eye(3) - np.outer(p, p)),
            "with the outer product the printed tensors agree",
        ),
        (
            "equation_2.printed",
            "equation (2)",
            "I_Link = I_COM + m SKEW(P)^2",
            lambda m, p: m * cross_matrix(p) @ cross_matrix(p),
            "SKEW(P)^2 is negative, so the printed sign takes the term away instead of adding it",
        ),
        (
            "equation_2.corrected",
            "equation (2)",
            "the same with - m SKEW(P)^2",
            lambda m, p: -m * cross_matrix(p) @ cross_matrix(p),
            "with the minus sign the printed tensors agree",
        ),
    )
    rows = []
    for claim, equation, says, form, finding in forms:

        def residual(x: FloatArray, form: _Form = form) -> FloatArray:
            mass, com, at_com, at_link = _read(x)
            return at_link - at_com - form(mass, com)

        value, bound = residual(_si(inputs)), rounding_bound(residual, inputs)
        i, j = _worst(value, bound)
        rows.append(
            judged(
                claim,
                f"Section 2.1, {equation}, on link {row.link}",
                says,
                abs(value[i, j]) / TENSOR_UNIT,
                "=",
                0.0,
                bound[i, j] / TENSOR_UNIT,
                "kg mm^2",
                finding,
                law=True,
            )
        )
    return rows


def _any_frame(row: InertialRow) -> AuditRow:
    """The corrected equation from the link frame, which is not at the COM, to the COM."""
    inputs = _inputs(row)

    def residual(x: FloatArray) -> FloatArray:
        mass, com, at_com, at_link = _read(x)
        return tensor_at_origin(mass, com, at_link) - at_com

    value, bound = residual(_si(inputs)), rounding_bound(residual, inputs)
    i, j = _worst(value, bound)
    return judged(
        "equation_1.any_frame",
        f"Section 2.1, equation (1), on link {row.link}",
        "I_A is the inertia with respect to {A}, any frame",
        abs(value[i, j]) / TENSOR_UNIT,
        "=",
        0.0,
        bound[i, j] / TENSOR_UNIT,
        "kg mm^2",
        "the theorem starts at the COM: from the link frame to the COM the corrected equation adds the term "
        "again, where it must be taken away",
        law=True,
    )


def _rotation(rows: tuple[InertialRow, ...], p: Alpha5Parameters) -> list[AuditRow]:
    """I_COM of links 1 to 4 carried from inertial frame {i} into the axes of DH frame {i}.

    The moment about an axis does not ask in which frame it is computed: that is the second route.
    """
    misses = np.zeros(2)
    axes = np.array([[1, 0, 0], [0, 1, 0], [0, 0, 1], [1, 1, 0], [1, 0, 1], [0, 1, 1]])
    axes = axes / np.linalg.norm(axes, axis=1, keepdims=True)
    for row, dh in zip(rows, p.dh, strict=False):
        _, _, tensor, _ = _read(_si(_inputs(row)))
        c, s = np.cos(dh.alpha), np.sin(dh.alpha)
        # Turns frame {i} into DH frame {i}; its transpose maps coordinates from {i} to DH {i}.
        turn = np.array([[1, 0, 0], [0, c, -s], [0, s, c]])
        true = np.einsum("ni,ij,nj->n", axes, tensor, axes)
        for k, rotation in enumerate((turn, turn.T)):
            carried = rotation @ tensor @ rotation.T
            seen = axes @ turn
            moments = np.einsum("ni,ij,nj->n", seen, carried, seen)
            misses[k] = max(misses[k], np.abs(moments - true).max() / TENSOR_UNIT)
    return [
        judged(
            f"equation_1.{name}",
            "Section 2.1, equation (1), rotation, links 1 to 4",
            says,
            float(miss),
            "=",
            0.0,
            ARITHMETIC,
            "kg mm^2",
            finding,
        )
        for name, says, miss, finding in (
            (
                "rotation",
                "R_A/B is the rotation from {A} to {B}",
                misses[0],
                "moment about one axis, from inertial frame {i} to DH frame {i}, with R turning {A} into {B} as "
                "Section 2 uses the word: the transpose is needed",
            ),
            (
                "rotation_of_coordinates",
                "R_A/B maps coordinates in {A} to coordinates in {B}",
                misses[1],
                "the same with R read so: the equation holds",
            ),
        )
    ]


def _implied_mass(row: InertialRow) -> AuditRow:
    inputs = _inputs(row)
    printed, implied = row.mass.si, float(_mass(_si(inputs)))
    bound = float(rounding_bound(lambda x: _mass(x) - x[0], inputs))
    lever = float(np.linalg.norm([c.si for c in row.com]))
    return judged(
        f"implied_mass.link_{row.link}",
        _place(row, ", mass"),
        f"mass {row.mass}",
        implied,
        "=",
        printed,
        bound,
        "kg",
        "the mass that best carries I_COM to I_Link (least squares); the effect is the weight of "
        "the difference at the COM's distance from the link frame",
        effect=abs(implied - printed) * GRAVITY * lever,
        effect_unit="N m",
    )


def _mass(x: FloatArray) -> float:
    """The m that minimizes |I_Link - I_COM - m (P.P E - P P^T)|."""
    _, com, at_com, at_link = _read(x)
    term = point_mass_tensor(1.0, com)
    return float(np.sum(term * (at_link - at_com)) / np.sum(term * term))


def _total_mass(rows: tuple[InertialRow, ...]) -> AuditRow:
    inputs = [q for row in rows for q in _inputs(row)]
    implied = sum(_mass(_si(_inputs(row))) for row in rows)

    def difference(x: FloatArray) -> float:
        return float(sum(_mass(y) - y[0] for y in x.reshape(len(rows), -1)))

    total = sum((row.mass.value for row in rows), start=rows[0].mass.value * 0)
    return judged(
        "total.mass",
        "Section 2.1, Table 2, mass",
        f"the masses add up to {total} kg",
        implied,
        "=",
        float(total),
        float(rounding_bound(difference, inputs)),
        "kg",
        "the sum of the masses that the two tensors of each link imply",
    )


def _possible(row: InertialRow, name: str) -> AuditRow:
    inputs = _inputs(row)

    def smallest(x: FloatArray) -> float:
        mass, com, at_com, at_link = _read(x)
        tensor = at_com if name == "com" else tensor_at_com(mass, com, at_link)
        return float(principal_moments(second_moments(tensor))[0])

    label = "I_COM" if name == "com" else "I_Link"
    return judged(
        f"possible_{name}.link_{row.link}",
        _place(row, f", {label}"),
        f"{label} is the tensor of a body",
        smallest(_si(inputs)) / TENSOR_UNIT,
        ">=",
        0.0,
        float(rounding_bound(smallest, inputs)) / TENSOR_UNIT,
        "kg mm^2",
        "smallest principal second moment of mass about the COM: positive means a positive definite "
        "tensor, the triangle inequality and a positive definite pseudo-inertia",
        law=True,
    )


def _com_inside(row: InertialRow, bounds: FloatArray) -> AuditRow:
    def excess(x: FloatArray) -> float:
        return excess_of_box(x, bounds)

    return judged(
        f"com_inside.link_{row.link}",
        _place(row, ", COM"),
        "COM in the inertial frame of Section 2",
        excess(np.array([c.si for c in row.com])) / MM,
        "<=",
        0.0,
        float(rounding_bound(excess, row.com)) / MM,
        "mm",
        "distance of the COM from the body's outer bounds, 0 inside",
    )


def _spread(mass: float, at_com: FloatArray) -> FloatArray:
    """Standard deviation of the mass along each axis [m]; 0 where the tensor is impossible."""
    out: FloatArray = np.sqrt(np.maximum(np.diag(second_moments(at_com)) / mass, 0.0))
    return out


def _mass_spread(row: InertialRow, bounds: FloatArray) -> AuditRow:
    """Along each axis the standard deviation of the mass is at most sqrt((max-c)(c-min))."""
    inputs = _inputs(row)

    def excess(x: FloatArray) -> FloatArray:
        mass, com, at_com, _ = _read(x)
        spread = _spread(mass, at_com)
        low, high = np.maximum(com - bounds[:, 0], 0.0), np.maximum(bounds[:, 1] - com, 0.0)
        out: FloatArray = spread - np.sqrt(low * high)
        return out

    value, bound = excess(_si(inputs)), rounding_bound(excess, inputs)
    k = int(np.argmax(value - bound))
    mass, _, at_com, _ = _read(_si(inputs))
    spread = float(_spread(mass, at_com)[k])
    fits = value[k] <= bound[k]
    return judged(
        f"mass_spread.link_{row.link}",
        _place(row, ", I_COM"),
        "I_COM fits a body of this size",
        spread / MM,
        "<=",
        (spread - value[k]) / MM,
        bound[k] / MM,
        "mm",
        f"standard deviation of the mass along {'xyz'[k]} against the most that the body's bounds allow"
        + ("" if fits else "; part of this mass turns inside the neighbour's housing"),
    )


def _jaw_plane(printed: Published) -> list[AuditRow]:
    """In which plane through the wrist axis link 4 has its closed fingers, and how much they weigh."""
    row, jaws = printed.table_2.rows[4], printed.supplementary.jaws
    offset, volume, density, sdk = (
        jaws[name].quantity
        for name in ("pivot_offset", "finger_volume", "finger_density", "sdk_plane")
    )
    xx, yy, xy = row.inertia_com[0][0], row.inertia_com[1][1], row.inertia_com[0][1]

    def direction(x: FloatArray) -> float:
        """Of the greatest spread of mass, from x of {4} [rad]; products with the document's sign."""
        return float(np.arctan2(2 * x[2], x[1] - x[0]) / 2)

    def excess(x: FloatArray) -> float:
        """I_yy - I_xx less that of two points at the pivots."""
        return float(x[1] - x[0] - 2 * x[2] ** 2 * x[3] * x[4])

    tensor, fingers = [xx, yy, xy], [xx, yy, offset, volume, density]
    points = 2 * offset.si**2 * volume.si * density.si
    spread = yy.si - xx.si
    return [
        judged(
            "jaw_plane.direction",
            _place(row, ", I_COM"),
            "link 4 includes interlocking jaws in the closed position",
            np.degrees(direction(_si(tensor))),
            "=",
            np.degrees(sdk.si),
            np.degrees(float(rounding_bound(direction, tensor)) + sdk.rounding),
            "deg",
            "direction of the fingers from x of {4} by the principal axes, against the SDK's URDF at equal "
            "axis_b; no source settles the zero of axis_b against it",
            kind="observation",
        ),
        judged(
            "jaw_plane.spread",
            _place(row, ", I_COM"),
            "link 4 includes interlocking jaws in the closed position",
            spread / TENSOR_UNIT,
            "=",
            points / TENSOR_UNIT,
            float(rounding_bound(excess, fingers)) / TENSOR_UNIT,
            "kg mm^2",
            f"I_yy - I_xx against two points at +-{offset} of the estimated mass of a finger, "
            f"{1e3 * volume.si * density.si:.3g} g; fingers of {spread / (2 * offset.si**2) * 1e3:.3g} g would "
            "give it",
            kind="observation",
        ),
    ]
