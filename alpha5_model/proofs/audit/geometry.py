"""Sections 1 and 2: frames, inverse kinematics and the tori of the workspace.

References:
    [ReachAlpha] Manufacturer's document, Sections 1.1 to 1.4, Figure 2, and Sections 2
        and 2.2.
    [Cochran1977] Sampling Techniques, section 3.2: standard error of a sampled share.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from alpha5_model._support.checks import BoolArray, FloatArray
from alpha5_model._support.spatial import excess_of_box, wrap
from alpha5_model.kinematics import workspace
from alpha5_model.kinematics.half_plane import area
from alpha5_model.kinematics.ik import inverse_kinematics
from alpha5_model.numbers.fluids import GRAVITY
from alpha5_model.numbers.parameters import Alpha5Parameters
from alpha5_model.numbers.tables import Published
from alpha5_model.proofs.audit import printed_workspace
from alpha5_model.proofs.audit.printed_inverse_kinematics import (
    published_inverse_kinematics,
)
from alpha5_model.proofs.audit.row import AuditRow, Figure, figure, judged, si
from alpha5_model.theory.dh.chain import DHChain

#: Random joint positions, and points of the reachable volume.
SAMPLES = 4000
#: Two angles that differ by less are the same [rad].
_SAME = 1e-6


def rows(printed: Published, parameters: Alpha5Parameters) -> list[AuditRow]:
    """The rows of Sections 1 and 2 without the tables of bodies and motors."""
    return [
        *_frames(printed, parameters),
        *_inverse_kinematics(printed, parameters),
        *_tori(printed, parameters),
        *_shares(printed),
        _self_collision(),
    ]


def sampled_share(hits: BoolArray) -> Figure:
    """Share of True among independent samples (N,), with three standard errors.

    A standard error is sqrt(p (1 - p) / N) [Cochran1977].
    """
    number = max(hits.size, 1)
    share = hits.sum() / number
    return Figure(value=share, bound=3 * np.sqrt(share * (1 - share) / number))


def _frames(printed: Published, parameters: Alpha5Parameters) -> list[AuditRow]:
    base = parameters.links[0]
    moved = 2 * float(np.hypot(*base.com[:2]))

    def outside(com: FloatArray) -> float:
        """Distance of the COM of link 0 from its body, if {0} is as the text says."""
        return excess_of_box(com * [-1, -1, 1], base.bounds)

    largest = max(abs(row.alpha) for row in parameters.dh[:4])
    return [
        judged(
            "frames.first",
            Figure(float(printed.table_1.rows[0].link) - 1),
            relation=">=",
            place="Section 1.1, Table 1",
            says="row i leads from frame {i-1} to frame {i}",
            measures="frame from which row 0 leads, if i is the number of the row",
            finding="By Section 2, row 0 leads from frame {0} to frame {1}. The text "
            "is right if i is the number of the frame in which a row ends.",
            used="row i from frame {i} to frame {i+1}",
            category="reading",
        ),
        judged(
            "frames.aligned",
            Figure(largest),
            unit="deg",
            place="Section 2.2",
            says="the inertial frames are aligned with the DH frames",
            measures="largest angle between the two frames, if aligned means parallel",
            finding="In Section 2, inertial frame {i} is turned by theta but not yet "
            "by alpha. The text is right if aligned means placed as Section 2 says.",
            used="the frames of Section 2",
            category="reading",
        ),
        judged(
            "base_frame.link_0",
            figure(outside, printed.table_2.rows[0].com),
            relation="<=",
            unit="mm",
            place="Section 2, Table 2, link 0",
            says="frame {0} is DH frame {0} after the rotation pi",
            measures="how far the COM lies outside the base body of the public CAD, "
            "if DH frame {0} is that of x and y in Sections 1.3 and 1.4",
            finding="The base body lies on the -x side, to which theta_0 cannot turn "
            f"the arm. The rotation moves the COM by {1e3 * moved:.1f} mm, out of the "
            "body. The text is right if Figure 1, which we do not have, draws DH frame "
            "{0} the other way round.",
            used="DH frame {0} without the rotation: the correction base_frame",
            effect=moved * base.mass * -GRAVITY[2],
            cost="change of the moment on the mount, in air",
            category="reading",
        ),
    ]


# --- Sections 1.3 and 1.4 -------------------------------------------------------------


def _inverse_kinematics(
    printed: Published, parameters: Alpha5Parameters
) -> list[AuditRow]:
    """The printed formulas, at the tcp of random joint positions."""
    joints = parameters.joints[:4]
    lower = [joint.lower for joint in joints]
    upper = [joint.upper for joint in joints]
    q = np.random.default_rng(0).uniform(lower, upper, (SAMPLES, 4))
    chain = DHChain.alpha5(arm=parameters)
    target = chain.frames(q)[:, -1, :3, 3]
    solutions = published_inverse_kinematics(target)

    found = []
    in_range = []
    exact = []
    for pose in range(2):
        # The formulas do not mention the wrist.
        solution = np.column_stack([solutions[:, pose], q[:, 3]])
        exists = np.isfinite(solution).all(axis=-1)
        reached = chain.frames(solution[exists])[:, -1, :3, 3]
        exact.append(np.linalg.norm(reached - target[exists], axis=-1).max())
        found.append(exists & _is_same(wrap(solution - q)))
        in_range.append(exists & _is_same(solution - q))

    recovered = np.logical_or(*found)
    as_printed = np.logical_or(*in_range)
    all_four = inverse_kinematics(target, q[:, 3], arm=parameters).q
    by_all_four = _is_same(all_four - q[:, None]).any(axis=-1).mean()

    a_2 = printed_workspace.printed_lengths(printed)[2]
    opposite = printed.elbow.opposite
    offset = Figure(2 * a_2.si, 2 * a_2.rounding + opposite.rounding)
    return [
        judged(
            "inverse_kinematics.elbow_offset",
            offset,
            expected=opposite.si,
            unit="mm",
            place="Sections 1.3 and 1.4 against Table 1",
            says="arcsin(2 a_2 / l_1)",
            measures="2 a_2, compared with the elbow's offset in theta_c",
        ),
        *(
            judged(
                f"inverse_kinematics.{pose}",
                Figure(miss),
                unit="mm",
                place=f"Section {section}",
                says=f"analytical solution, {pose} pose",
                measures="largest distance between a target and the tcp at its "
                "solution, for random targets",
            )
            for pose, section, miss in zip(
                ("underarm", "overarm"), ("1.3", "1.4"), exact, strict=True
            )
        ),
        judged(
            "inverse_kinematics.branches",
            sampled_share(recovered),
            expected=1.0,
            relation=">=",
            unit="%",
            kind="observation",
            place="Sections 1.3 and 1.4",
            says="two poses, underarm and overarm",
            measures="share of random joint positions that the two formulas recover",
            finding="Each pose has a second solution, with the elbow bent the other "
            f"way. The four solutions recover {100 * by_all_four:.4g} %.",
            used="all four solutions",
        ),
        judged(
            "inverse_kinematics.wrapping",
            sampled_share(as_printed[recovered]),
            expected=1.0,
            relation=">=",
            unit="%",
            kind="observation",
            place="Sections 1.3 and 1.4",
            says="angles with no range",
            measures="share of the recovered positions that come out within the limits",
            finding="The other angles are a full turn away.",
            used="angles wrapped into the limits",
        ),
    ]


def _is_same(difference: FloatArray) -> BoolArray:
    """Which joint positions (..., 4) do not differ."""
    return np.asarray(np.abs(difference).max(axis=-1) < _SAME)


# --- Section 1.2 ----------------------------------------------------------------------


def _tori(printed: Published, parameters: Alpha5Parameters) -> list[AuditRow]:
    """The lengths in the formulas of the tori."""
    numbers = printed.workspace
    elbow = printed.elbow
    a_0, _, a_2, d_3, *_ = printed_workspace.printed_lengths(printed)
    forearm = float(np.hypot(a_2.si, d_3.si))
    chain = DHChain.alpha5(arm=parameters)

    def from_shoulder(theta_2: float) -> float:
        """Distance of the tcp from the shoulder, DH frame {1} [m]."""
        frames = chain.frames([0.0, 0.0, theta_2, 0.0])
        return float(np.linalg.norm(frames[-1, :3, 3] - frames[1, :3, 3]))

    # The elbow stretched, or as near to that as its limits allow.
    joint = parameters.joints[2]
    stretched = workspace.singular_elbow_angles(arm=parameters)["stretched"]
    longest = from_shoulder(float(np.clip(stretched, joint.lower, joint.upper)))

    def radius(x: FloatArray) -> float:
        return float(np.hypot(x[0] + x[2], x[1] + x[3]))

    def excess(x: FloatArray) -> float:
        """The inner radius as printed less that with the caption's lengths."""
        return radius(x[:4]) - radius(np.append(x[4:], x[2:4]))

    inner = [numbers.inner_offset, numbers.inner_length, a_2, d_3]
    rounding = figure(excess, [*inner, elbow.opposite, elbow.adjacent]).bound

    elbow_at_zero = chain.frames(np.zeros(4))[2, :3, 3]
    aside = float(np.hypot(*elbow_at_zero[:2])) - parameters.dh[0].a
    without_a_2 = figure(lambda x: np.hypot(*x) - abs(x[1]), [a_2, d_3])

    def judge(
        name: str, figure: Figure, expected: float, torus: str, **words: Any
    ) -> AuditRow:
        return judged(
            f"workspace.{name}",
            figure,
            expected=expected,
            unit="mm",
            place=f"Section 1.2, {torus} torus",
            used="the exact workspace, by forward kinematics",
            effect=abs(figure.value - expected),
            effect_unit="mm",
            cost="difference between the two lengths",
            **words,
        )

    return [
        judge(
            "inner_offset",
            Figure(
                numbers.inner_offset.si,
                numbers.inner_offset.rounding + elbow.opposite.rounding,
            ),
            elbow.opposite.si,
            "inner",
            says=f"{numbers.inner_offset.text} where Table 1 has {elbow.opposite.text}",
            measures="this length, compared with Table 1",
        ),
        judge(
            "outer_torus",
            Figure(longest),
            parameters.dh[1].a + forearm,
            "outer",
            says="radius a_1 + sqrt(d_3^2 + a_2^2)",
            measures="longest distance from the shoulder to the tcp within the limits "
            "of theta_2, compared with the torus",
        ),
        judge(
            "inner_torus",
            Figure(radius(si(inner)), rounding),
            from_shoulder(0.0),
            "inner",
            says=f"radius sqrt(({numbers.inner_offset.text} + a_2)^2 + "
            f"({numbers.inner_length.text} + d_3)^2)",
            measures="radius of the torus, compared with the distance from the "
            "shoulder to the tcp at theta_2 = 0",
        ),
        judge(
            "downward_centre",
            Figure(aside, a_0.rounding + elbow.opposite.rounding),
            0.0,
            "downward",
            says=f"centre {numbers.downward_drop.text} below the shoulder",
            measures="horizontal distance of the elbow from the shoulder at "
            "theta_1 = 0",
            finding="The formula puts the elbow straight below the shoulder.",
        ),
        judge(
            "downward_radius",
            Figure(forearm, without_a_2.bound),
            -d_3.si,
            "downward",
            says="radius -d_3",
            measures="distance from the elbow to the tcp, sqrt(a_2^2 + d_3^2)",
            finding="The formula leaves out a_2.",
        ),
    ]


def _shares(printed: Published) -> list[AuditRow]:
    """Areas of the half-plane R >= 0: between the printed tori, and within the limits.

    The areas are exact. Rounding of the printed lengths moves the tori, not the arm.
    """
    lengths = printed_workspace.printed_lengths(printed)
    reached = workspace.cross_section_area()

    def shares(x: FloatArray) -> FloatArray:
        """Of the region, what is not reached; of the reach, what is not in it."""
        tori = printed_workspace.tori(x)
        beyond = area(printed_workspace.difference(tori, "both", published=True))
        missed = area(printed_workspace.difference(tori, "both", published=False))
        return np.array([beyond / (reached - missed + beyond), missed / reached])

    both = figure(shares, lengths)
    beyond, missed = (Figure(*pair) for pair in zip(*both, strict=True))
    # The document draws the inner and the downward torus for the underarm pose.
    tori = printed_workspace.tori(si(lengths))
    left_out = area(printed_workspace.difference(tori, "underarm", published=False))
    underarm = left_out / workspace.cross_section_area("underarm")
    return [
        judged(
            "workspace.beyond_reach",
            beyond,
            unit="%",
            place="Section 1.2, Figure 2",
            says="the reachable workspace lies between the tori",
            measures="share of the area between the tori, in a half-plane through the "
            "yaw axis, that the arm does not reach within its limits",
            finding="The text is right if the tori are outer bounds only; it calls "
            "them limits.",
            used="the exact workspace",
            category="reading",
        ),
        judged(
            "workspace.left_out",
            missed,
            unit="%",
            place="Section 1.2, Figure 2",
            says="no point outside the tori is reached",
            measures="share of the reachable area that lies outside the tori",
            finding=f"The share is {100 * underarm:.2g} % if the tori are meant for "
            "the underarm pose only.",
            used="the exact workspace",
            category="reading",
        ),
    ]


def _self_collision() -> AuditRow:
    """The share of the reachable volume that is reached in self-collision only."""
    # Imported late: it loads Pinocchio.
    from alpha5_model.collision.self_collision import without_self_collision

    free = workspace.sampled_share(without_self_collision, SAMPLES)
    return judged(
        "workspace.self_collision",
        Figure(1 - free.share, 3 * free.standard_error),
        unit="%",
        place="Section 1.2, Figure 2",
        says="Reachable workspace without self collision",
        measures="share of the reachable volume that the arm, with the bodies of this "
        "package, reaches only in self-collision",
        finding="The caption is right if it means that self-collision was not "
        "considered.",
        used="the whole volume; accept=a5.without_self_collision leaves out this share",
        category="reading",
    )
