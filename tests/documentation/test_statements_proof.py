"""Numbers of the pages on proof, moving water, simulators and uncertainty."""

from __future__ import annotations

import ast
import json
import subprocess
import sys
import tomllib
from collections.abc import Sequence
from dataclasses import replace
from functools import cache
from typing import Any

import numpy as np
import pytest
import reference
from current_load import load as current_load
from dynamics_cases import VARIANTS, make, moved, random_q, random_v
from fk import sample, tip
from hydrodynamics.revolution import cylinder_across
from newton_euler import newton_euler
from reference import LOWER, UPPER
from shared_recordings import (
    POOL,
    RECORDINGS,
    UNTIDY,
    needs_recordings,
    pool_recordings,
    tilt_recordings,
)
from statement_registry import (
    REPOSITORY,
    AtMost,
    Figure,
    Near,
    Statement,
    parameters_of,
    statement,
    text_of,
)
from test_moving_water_export import moving, own_torque
from test_uncertainty import of_link, states

import alpha5_model as a5
from alpha5_model.codegen.regrouping import base_parameters
from alpha5_model.numbers.hydrodynamics import LEVELS, hydrodynamics
from alpha5_model.water.arm import HydrodynamicArm

PROOF = "docs/proof.md"
WATER = "docs/guides/moving-water.md"
SIMULATORS = "docs/conformance.md"
UNCERTAINTY = "docs/concepts/uncertainty.md"
JOINTS = a5.parameters().joints[:4]


# --- simulators ----------------------------------------------------------------------


@statement(
    "docs/guides/isaac-lab.md",
    "Without the buoyancy of {} N, `axis_d` carries up to {} N·m too much",
)
def left_out_water() -> Sequence[Figure]:
    arm = a5.load()
    volume = sum(link.volume for link in a5.parameters().links)
    turns = [np.linspace(joint.lower, joint.upper, 60) for joint in JOINTS[1:3]]
    poses = np.stack(np.meshgrid(*turns), axis=-1).reshape(-1, 2)
    torques = [arm.buoyancy_torque(np.array([0.0, *pose, 0.0]))[1] for pose in poses]
    return Near(volume * a5.SEA_WATER * 9.81), Near(np.abs(torques).max(), 0.002)


# --- how it is proven ----------------------------------------------------------------


@statement(PROOF, "product of Table 1's rows, typed again | {} m, rad")
def forward_kinematics() -> Sequence[Figure]:
    arm, worst = a5.load(), 0.0
    for q in reference.configurations(300, seed=3):
        named = {
            f"link_{i}": frame for i, frame in enumerate(reference.inertial_frames(q))
        }
        named["tcp"] = reference.dh_frames(q)[-1]
        for name, frame in named.items():
            gap = np.abs(arm.forward_kinematics(q, name).homogeneous - frame).max()
            worst = max(worst, float(gap))
    return [AtMost(worst)]


@statement(PROOF, "{} of {} random in-limit configurations are found again | {} m")
def inverse_kinematics() -> Sequence[Figure]:
    q = sample(200_000, seed=78)
    target = tip(q)
    solutions = a5.inverse_kinematics(target, q[:, 3])
    off = np.abs(solutions.q - q[:, None]).max(axis=-1)
    found = (np.where(solutions.within_limits, off, np.inf).min(axis=-1) < 1e-6).sum()
    wanted = np.broadcast_to(target[:, None], (len(q), 4, 3))[solutions.exists]
    miss = np.linalg.norm(tip(solutions.q[solutions.exists]) - wanted, axis=-1).max()
    return [Near(int(found)), Near(len(q)), AtMost(float(miss))]


@cache
def random_states(count: int) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    rng = np.random.default_rng(5)
    q = rng.uniform(LOWER, UPPER, (count, 4))
    return q, rng.normal(size=(count, 4)), rng.normal(size=(count, 4))


@statement(PROOF, "straight from Tables 1–3, {} states | {} N·m")
def inverse_dynamics() -> Sequence[Figure]:
    q, v, a = random_states(20_000)
    theirs, _, _ = newton_euler(q, v, a, a5.SEA_WATER)
    arm = a5.load()
    batch = np.abs(arm.inverse_dynamics_batch(q, v, a) - theirs).max()
    single = [
        arm.inverse_dynamics(*x) for x in zip(q[:2000], v[:2000], a[:2000], strict=True)
    ]
    return [
        Near(len(q)),
        AtMost(max(float(batch), float(np.abs(single - theirs[:2000]).max()))),
    ]


@statement(PROOF, "the same Newton–Euler, with and without water | {} N·m")
def buoyancy() -> Sequence[Figure]:
    q, _, _ = random_states(20_000)
    q, arm = q[:2000], a5.load()
    still = np.zeros_like(q)
    air, sea = (
        newton_euler(q, still, still, density)[0] for density in (0.0, a5.SEA_WATER)
    )
    ours = np.array([arm.buoyancy_torque(x) for x in q])
    return [AtMost(float(np.abs(ours - (air - sea)).max()))]


@statement(
    PROOF,
    "finite differences, with and without water, payload, floating base | {} relative",
)
def derivatives() -> Sequence[Figure]:
    """Central differences of order 6, each kind of arm."""
    rng, worst = np.random.default_rng(1), 0.0
    for variant in VARIANTS:
        arm = make(variant)
        q, v, a = random_q(arm, rng), random_v(arm, rng), random_v(arm, rng)
        ours, _, _ = arm.inverse_dynamics_derivatives(q, v, a)
        columns = []
        for i in range(arm.model.nv):
            step = np.zeros(arm.model.nv)
            # of the jaw rod in metres: its fingers turn by 51 rad/m
            step[i] = (
                8e-5 if i == arm.model.nv - 1 and "axis_a" in arm.joint_names else 4e-3
            )
            f = {
                k: arm.inverse_dynamics(moved(arm, q, k * step), v, a)
                for k in (-3, -2, -1, 1, 2, 3)
            }
            slope = 45 * (f[1] - f[-1]) - 9 * (f[2] - f[-2]) + (f[3] - f[-3])
            columns.append(slope / (60 * step[i]))
        theirs = np.column_stack(columns)
        worst = max(worst, float(np.abs(ours - theirs).max() / np.abs(theirs).max()))
    return [AtMost(worst)]


@statement(
    PROOF, "those rings against three cylinders of the handbook DNV-RP-H103 | {} %"
)
def cylinders_of_the_handbook() -> Sequence[Figure]:
    printed = {1.2: 0.62, 2.5: 0.78, 5.0: 0.90}
    off = [abs(cylinder_across(ratio) / value - 1) for ratio, value in printed.items()]
    return [Near(100 * max(off))]


@statement(PROOF, "mesh volumes | Table 3 | {} relative")
def mesh_volumes() -> Sequence[Figure]:
    volumes = {
        name: obj_volume(name)
        for name in ("link_0", "link_1", "link_2", "link_3", "link_4")
    }
    volumes["link_4"] += obj_volume("finger_1") + obj_volume("finger_2")
    found = np.array(list(volumes.values())) * 1e3
    return [AtMost(float(np.abs(found / reference.VOLUME - 1).max()))]


def obj_volume(name: str) -> float:
    """Volume within the triangles of a committed mesh [m^3], by Gauss's theorem."""
    lines = (REPOSITORY / "meshes" / f"{name}.obj").read_text("utf-8").splitlines()
    vertices = np.array(
        [line.split()[1:4] for line in lines if line.startswith("v ")], dtype=float
    )
    faces = [
        [int(corner.split("/")[0]) - 1 for corner in line.split()[1:]]
        for line in lines
        if line.startswith("f ")
    ]
    a, b, c = vertices[np.array(faces)].swapaxes(0, 1)
    return float(np.einsum("ij,ij->i", a, np.cross(b, c)).sum() / 6)


#: Words of a row, the bound that it prints -> test that holds it, in the same letters.
HELD = {
    "multi-start numerical minimisation | 1e-13 m": (
        "test_workspace.test_distance_is_the_least_over_all_joint_positions",
        "1e-13",
    ),
    "forward of inverse dynamics | 1e-10 relative": (
        "test_hydrodynamic_arm.test_forward_and_inverse_dynamics_undo_each_other",
        "1e-10",
    ),
    "power balance; energy of an undamped run | 1e-8 relative; 1e-8 J": (
        "test_hydrodynamic_arm.test_power_balance",
        "rel=1e-8",
    ),
    "; energy of an undamped run | 1e-8 relative; 1e-8 J": (
        "test_hydrodynamic_arm.test_energy_of_an_undamped_run_is_kept",
        "< 1e-8",
    ),
    "a cylinder's closed forms; MuJoCo's ellipsoid | 1e-12; 1e-7 relative": (
        "test_hydrodynamic_arm.test_drag_of_a_turning_cylinder",
        "rel=1e-12",
    ),
    "; MuJoCo's ellipsoid | 1e-12; 1e-7 relative": (
        "test_hydrodynamic_arm.test_mujoco_turns_an_ellipsoid_by_the_same_moment",
        "1e-7",
    ),
}


@pytest.mark.parametrize("words", HELD)
def test_a_test_holds_what_the_page_says(words: str) -> None:
    assert Statement(PROOF, words, list).found()
    place, bound = HELD[words]
    module, _, name = place.partition(".")
    (file,) = (REPOSITORY / "tests").rglob(f"{module}.py")
    source = file.read_text("utf-8")
    (test,) = (
        node
        for node in ast.parse(source).body
        if isinstance(node, ast.FunctionDef) and node.name == name
    )
    assert bound in (ast.get_source_segment(source, test) or "")


def test_the_script_refuses_what_the_page_says_of_added_mass() -> None:
    words = "sphere and ellipsoid after Lamb, cylinders by rings of sources | 1.5 %"
    assert Statement(PROOF, words, list).found()
    assert "TOLERANCE = 0.015" in text_of("scripts/hydrodynamics/added_mass.py")


# --- the recordings of the pool ------------------------------------------------------


@cache
def script(name: str, *arguments: str) -> dict[str, Any]:
    """A script's figures as JSON."""
    done = subprocess.run(
        [sys.executable, str(REPOSITORY / "scripts" / name), *arguments, "--json"],
        capture_output=True,
        text=True,
        check=True,
    )
    found: dict[str, Any] = json.loads(done.stdout)
    return found


def r2(record: dict[str, Any], model: str = "model") -> tuple[float, float]:
    """Held-out R^2 in pitch and roll."""
    scores = record["models"][model]
    return scores["pitch"]["r2"], scores["roll"]["r2"]


@statement(PROOF, "R² {} in pitch, {} in roll", needs_recordings)
def two_untidy_recordings() -> Sequence[Figure]:
    untidy = script(
        "recordings/validate_recordings.py",
        f"{RECORDINGS}/untidy",
        "--fit",
        str(RECORDINGS),
    )
    assert sorted(untidy["recordings"]) == ["traj003-0-test", "traj007-1"]
    return [Near(x) for x in r2(untidy)]


@statement(
    PROOF,
    "is predicted from the other half, R² is {} in pitch and {} in roll",
    needs_recordings,
)
def four_recordings() -> Sequence[Figure]:
    return [
        Near(x)
        for x in r2(script("recordings/validate_recordings.py", str(RECORDINGS)))
    ]


@statement(
    PROOF,
    "For 26 more recordings, predicted from those four, R² is {} in roll and {} in "
    "pitch",
    needs_recordings,
)
def recordings_of_the_pool() -> Sequence[Figure]:
    one, other = pool_recordings()
    four = a5.fit_tilt(tilt_recordings(RECORDINGS))
    return [Near(float(x)) for x in four.score([*one, *other])]


@statement(WATER, "R² is {} in roll and {} in pitch with and without", needs_recordings)
def tilt_does_not_show_moving_water() -> Sequence[Figure]:
    four = script("recordings/validate_recordings.py", str(RECORDINGS))
    pitch, roll = r2(four)
    assert r2(four, "in moving water") == pytest.approx((pitch, roll), abs=5e-4)
    return [Near(roll), Near(pitch)]


@cache
def identified() -> dict[str, Any]:
    return script(
        "recordings/identify_recordings.py",
        *(str(folder) for folder in (RECORDINGS, UNTIDY, POOL)),
    )


@statement(
    UNCERTAINTY,
    "| link 2's moment across its length | {} % | | the moment that links 2 and 3 "
    "have together | {} % | | the best known of three more | {} % | | the least known "
    "of three more | {} % | | the wrist's moment across its axis | not known | The "
    "printed digits know these five combinations {} to {} times better",
    needs_recordings,
)
def combinations() -> Sequence[Figure]:
    found = identified()["combinations"]
    data = [100 * x["deviation"] for x in found[:5]]
    better = [x["deviation"] / x["by_digits"] for x in found[:5]]
    assert found[5]["deviation"] > 1
    assert len(identified()["recordings"]) == 32
    return [
        Near(data[0]),
        Near(data[1]),
        Near(data[2]),
        Near(data[4]),
        Near(min(better)),
        Near(max(better)),
    ]


@statement(
    UNCERTAINTY,
    "parallel to the vehicle's, the best fit is at {} with a standard error of {}. "
    "That rejects both",
    needs_recordings,
)
def centre_of_buoyancy_with_parallel_axes() -> Sequence[Figure]:
    found = identified()["link3_cob"]
    place = found["fits_best_at"]
    assert place - 1 > 2 * found["standard_error"]
    return [Near(place), Near(found["standard_error"])]


@statement(
    UNCERTAINTY,
    "the arm is turned by {}° about the vehicle's vertical, with a standard error of "
    "{}°.",
    needs_recordings,
)
def turn_of_the_arm() -> Sequence[Figure]:
    found = identified()["link3_cob"]["turned"]
    return [Near(found["yaw_deg"]), Near(found["yaw_standard_error_deg"])]


@statement(
    UNCERTAINTY,
    "With the angle, the best fit is at {} with a standard error of {}. So these "
    "recordings **cannot tell**. The corrected point fits well, and the printed "
    "one is {} standard errors away",
    needs_recordings,
)
def centre_of_buoyancy_with_a_turned_arm() -> Sequence[Figure]:
    found = identified()["link3_cob"]["turned"]
    place = found["fits_best_at"]
    error = found["standard_error"]
    assert abs(place - 1) < error
    return [Near(place), Near(error), Near(place / error)]


@statement(
    UNCERTAINTY,
    "| axes parallel, corrected | {} | {} | | axes parallel, printed | {} | {} | "
    "| arm turned, corrected | {} | {} | | arm turned, printed | {} | {} |",
    needs_recordings,
)
def scores_of_both_centres() -> Sequence[Figure]:
    found = identified()["link3_cob"]
    scores = [
        one[f"held_out_r2_{name}"]
        for one in (found, found["turned"])
        for name in ("corrected", "printed")
    ]
    return [Near(x) for pair in scores for x in pair]


@statement(
    UNCERTAINTY,
    "it is {}°, and on the others {}°. Each half predicts the other: R² is {} and {} "
    "in roll, {} and {} in pitch",
    needs_recordings,
)
def each_half_of_the_pool() -> Sequence[Figure]:
    halves = pool_recordings()
    one, other = (a5.fit_tilt(half) for half in halves)
    by_one = one.score(halves[1])
    by_other = other.score(halves[0])
    scores = [by_one[0], by_other[0], by_one[1], by_other[1]]
    angles = [np.degrees(one.yaw), np.degrees(other.yaw)]
    return [Near(float(x)) for x in (*angles, *scores)]


# --- moving water --------------------------------------------------------------------


@cache
def at_rated_speed() -> tuple[np.ndarray, np.ndarray]:
    """Torque with the estimated water and without, 20 000 positions, joints at rated
    speed either way.
    """
    rng = np.random.default_rng(0)
    q = rng.uniform(LOWER, UPPER, (20_000, 4))
    speed = np.array([joint.velocity for joint in JOINTS])
    v = speed * rng.choice([-1, 1], q.shape)
    arm = a5.load()
    dry = arm.inverse_dynamics_batch(q, v, 0 * v)
    wet = arm.with_hydrodynamics().inverse_dynamics_batch(q, v, 0 * v)
    return wet, dry


@statement(
    WATER,
    "in either direction, at {} random positions and without acceleration. These "
    "are medians: | | axis_e | axis_d | axis_c | axis_b | |---|---|---|---|---| | "
    "error as a share of the torque | {} % | {} % | {} % | {} % | | error [mN m] | {} "
    "| {} | {} | {} |",
)
def still_water() -> Sequence[Figure]:
    wet, dry = at_rated_speed()
    error = np.abs(wet - dry)
    shares = 100 * np.median(error / np.abs(dry), axis=0)
    sizes = 1e3 * np.median(error, axis=0)
    return [Near(len(wet)), *map(Near, shares), *map(Near, sizes)]


def test_drag_in_still_water_by_a_second_route() -> None:
    """A joint that turns alone in still water: the strips' drag, by the tests' own
    sums.
    """
    rng = np.random.default_rng(4)
    wet, arm = a5.load().with_hydrodynamics(), a5.load()
    for k in range(3):
        q = rng.uniform(LOWER, UPPER)
        v = np.eye(4)[k] * JOINTS[k].velocity
        ours = (
            wet.inverse_dynamics(q, v, 0 * v) - arm.inverse_dynamics(q, v, 0 * v)
        ) @ v
        assert ours == pytest.approx(-own_torque(q, v, np.zeros(3)) @ v, rel=2e-3)


@cache
def added_diagonals() -> np.ndarray:
    """How much larger added mass makes the diagonal of M(q): low, nominal, high;
    medians [%], (3, 4).
    """
    q, arm = sample(1500, 6), a5.load()
    dry = np.array([np.diag(arm.mass_matrix(x)) for x in q])
    found = []
    for level in LEVELS:
        wet = arm.with_hydrodynamics(level=level)
        more = np.array([np.diag(wet.mass_matrix(x)) for x in q])
        found.append(100 * np.median(more / dry - 1, axis=0))
    return np.array(found)


@statement(
    WATER,
    "| joint | low | nominal | high | |---|---|---|---| | axis_e | {} % | {} % | "
    "{} % | | axis_d | {} % | {} % | {} % | | axis_c | {} % | {} % | {} % | | "
    "axis_b | {} % | {} % | {} % |",
)
def added_inertia() -> Sequence[Figure]:
    low, nominal, high = added_diagonals()
    triples = zip(low, nominal, high, strict=True)
    return [Near(x, 0.6) for triple in triples for x in triple]


@statement(
    "alpha5_model/description/templates/mjcf_moving_water.md",
    "larger by {}, {} and {} % on axis_e, axis_d and axis_c (medians)",
)
def added_inertia_for_mujoco() -> Sequence[Figure]:
    return [Near(x, 0.6) for x in added_diagonals()[1, :3]]


@cache
def other_bodies() -> dict[str, np.ndarray]:
    """Added mass of bodies of another shape, which match the tables as well."""
    file = REPOSITORY / "scripts" / "hydrodynamics" / "other_bodies.toml"
    bodies = tomllib.loads(file.read_text("utf-8"))
    return {
        name: np.array(body["added_mass"], dtype=float) for name, body in bodies.items()
    }


@statement(
    WATER,
    "differ by a factor of {} in the added mass of link 0 along itself, and of {} in "
    "that of link 4",
)
def two_sets_of_bodies() -> Sequence[Figure]:
    arm = a5.load(a5.FRESH_WATER).with_hydrodynamics()
    link_0 = other_bodies()["link_0"] / arm.added_mass("link_0")
    link_4 = other_bodies()["link_4"] / arm.added_mass("link_4")
    return [Near(link_0[0, 0], 0.01), Near(link_4[5, 5], 0.01)]


@statement(
    WATER,
    "gives {} of the nominal moment, at most {} instead of {} N m at 1 m/s",
)
def moment_of_a_current_on_axis_b() -> Sequence[Figure]:
    arm = a5.load()
    wet = arm.with_hydrodynamics()
    bodies = []
    for body in wet.bodies:
        data = replace(body.data, added_mass=other_bodies()[body.body])
        bodies.append(replace(body, data=data))
    other = HydrodynamicArm(arm, bodies)

    q = sample(3000, 6)
    still = np.zeros_like(q)
    current = np.random.default_rng(0).normal(size=(len(q), 3))
    current /= np.linalg.norm(current, axis=1)[:, None]
    dry = arm.inverse_dynamics_batch(q, still, still)[:, 3]
    ours, others = (
        water.inverse_dynamics_batch(q, still, still, current=current)[:, 3] - dry
        for water in (wet, other)
    )
    share = ours @ others / (ours @ ours)
    return [Near(share, 0.01), Near(abs(others).max()), Near(abs(ours).max())]


@statement(
    WATER, "across, for their mean width, goes from {} (narrow side) to {} (wide side)"
)
def drag_of_the_fingers() -> Sequence[Figure]:
    found = []
    for level in ("low", "high"):
        jaws = a5.load(gripper="jaws").with_hydrodynamics(level=level)
        across = []
        for body in jaws.bodies:
            if "finger" in body.body:
                across += [strip.across for strip in body.data.strips]
        found.append(across)
    low, high = found
    return [Near(min(low), 0.05), Near(max(high))]


@statement(
    WATER,
    "For the longest cylinder, panels and rings of sources both give {} of the "
    "displaced mass, where the handbook prints 0.90",
)
def longest_cylinder() -> Sequence[Figure]:
    return [Near(cylinder_across(5.0))]


def whole_arm(pose: str) -> dict[str, Any]:
    """The whole arm against the sum of its bodies, by added_mass.py of the scripts."""
    text = (REPOSITORY / "scripts" / "hydrodynamics" / "whole_arm.toml").read_text(
        "utf-8"
    )
    found: dict[str, Any] = tomllib.loads(text)[pose]
    return found


def least_and_most(pose: str) -> tuple[float, float]:
    """Of the shares along or about one axis of the base, and about the joints."""
    found = whole_arm(pose)
    shares = [*found["base"], *found["joints"]]
    return min(shares), max(shares)


@statement(
    WATER,
    "has {} to {} of the sum when it moves across itself or turns. When a joint moves, "
    "it is {} (axis_e), {} (axis_d), {} (axis_c) and {} (axis_b)",
)
def stretched_arm() -> Sequence[Figure]:
    found = whole_arm("extended")
    most = [*found["base"][1:], *found["joints"]]
    return [Near(x) for x in (min(most), max(most), *found["joints"])]


@statement(
    WATER,
    "only {} of the sum, because ends that face a neighbour push no water. What is "
    "missing, {} of {} kg, is {} % of the added mass across. - If the base of the "
    "stretched arm moves in random directions, 98 % of the motions have {} to {}",
)
def along_the_stretched_arm() -> Sequence[Figure]:
    found = whole_arm("extended")
    whole, bodies = found["kg"][0], found["kg"][3]
    across = found["kg"][4]
    low, _, high = found["random"]
    return [
        Near(found["base"][0]),
        Near(bodies - whole, 0.001),
        Near(bodies),
        Near(100 * (bodies - whole) / across),
        Near(low),
        Near(high),
    ]


@statement(
    WATER,
    "In a working pose the arm has {} to {} of the sum.",
)
def working_arm() -> Sequence[Figure]:
    return [Near(share) for share in least_and_most("working")]


@statement(
    WATER,
    "The interval below, {} to {} of the sum, covers the stretched arm and the working "
    "pose for motions along or about one axis",
)
def motions_about_one_axis() -> Sequence[Figure]:
    """The factor of all bodies, without the doubt about their shapes."""
    text = text_of("alpha5_model/numbers/estimated_hydrodynamics.toml")
    bodies = tomllib.loads(text)["bodies"].values()
    (factors,) = {tuple(body["added_mass_factor"]) for body in bodies}
    low, nominal, high = map(float, factors)
    assert nominal == 1.0
    for pose in ("extended", "working"):
        least, most = least_and_most(pose)
        assert low < least
        assert most < high
    return [Near(low), Near(high)]


@statement(WATER, "Folded it has {} to {}, which the interval does not cover")
def folded_arm() -> Sequence[Figure]:
    least, most = least_and_most("folded")
    low, nominal, high = (
        hydrodynamics(level=level)["link_2"].added_mass[1, 1] for level in LEVELS
    )
    assert least < low / nominal
    assert most > high / nominal
    return [Near(least), Near(most)]


# --- MuJoCo --------------------------------------------------------------------------


@cache
def mujocos_errors() -> dict[str, np.ndarray]:
    """MuJoCo's torque error relative to the torque, root mean squares by joint [%]."""
    mujoco, model, data = moving()
    rng = np.random.default_rng(8)
    errors: dict[str, list[Any]] = {"one joint": [], "drag": [], "current": []}
    sizes: dict[str, list[Any]] = {"one joint": [], "drag": [], "current": []}
    for _ in range(250):
        q = rng.uniform(LOWER, UPPER)
        flow = rng.normal(size=3)
        flow /= np.linalg.norm(flow)
        data.qpos, data.qvel, model.opt.wind = q, 0, flow
        mujoco.mj_forward(model, data)
        drag = own_torque(q, np.zeros(4), flow)
        whole = -current_load(q, flow, level=1)[0]
        found = data.qfrc_fluid.copy()
        for name, expected in (("drag", drag), ("current", whole)):
            errors[name].append(found - expected)
            sizes[name].append(expected)

        model.opt.wind = 0
        alone = []
        for k in range(3):
            v = rng.choice([-1, 1]) * np.eye(4)[k]
            data.qvel = v
            mujoco.mj_forward(model, data)
            alone.append((data.qfrc_fluid[k], own_torque(q, v, np.zeros(3))[k]))
        theirs, ours = np.array(alone).T
        errors["one joint"].append(theirs - ours)
        sizes["one joint"].append(ours)
    return {
        name: 100
        * np.sqrt(
            np.mean(np.square(errors[name]), axis=0)
            / np.mean(np.square(sizes[name]), axis=0)
        )
        for name in errors
    }


@statement(
    SIMULATORS,
    "| drag of one moving joint | {} % | {} % | {} % | – | "
    "| drag of a current of 1 m/s | {} % | {} % | {} % | {} % | "
    "| drag and Munk moment of a current of 1 m/s | {} % | {} % | {} % | {} % |",
)
def mujoco_in_moving_water() -> Sequence[Figure]:
    """The page has 1500 positions, here are 250."""
    found = mujocos_errors()
    return [
        *(Near(x, 0.1 * x) for x in found["one joint"]),
        *(Near(x, 0.15 * x) for x in found["drag"]),
        *(Near(x, 0.15 * x) for x in found["current"]),
    ]


@statement(
    "alpha5_model/description/templates/mjcf_moving_water.md",
    "the torques of a steady current are off by {}, {}, {} and {} % on axis_e, "
    "axis_d, axis_c and axis_b",
)
def mujoco_in_a_current() -> Sequence[Figure]:
    return [Near(x, 0.15 * x) for x in mujocos_errors()["current"]]


@statement(
    "alpha5_model/description/templates/mjcf_moving_water.md",
    "joint torques of drag alone are within {} % for one moving joint "
    "and {} % in a current",
)
def mujocos_drag() -> Sequence[Figure]:
    found = mujocos_errors()
    return [
        AtMost(found["one joint"].max()),
        Near(found["drag"].max(), 0.15 * found["drag"].max()),
    ]


# --- uncertainty ---------------------------------------------------------------------


def half_width(alternatives: tuple[str, ...]) -> float:
    """Of the guaranteed interval of axis_d at the pose reach [mN m]."""
    still = np.zeros(4)
    lower, upper = a5.uncertainty.torque_bounds(
        a5.named_pose("reach"), still, still, alternatives=alternatives
    )
    return 1e3 * float(upper[1] - lower[1]) / 2


@statement(
    UNCERTAINTY,
    "the guaranteed interval of axis_d is ±{} mN·m, and ±{} mN·m with "
    "`link2_mass`. Link 2's two tensors give a mass of {} ± {} kg",
)
def mass_of_link_2() -> Sequence[Figure]:
    # least squares over all nine entries, by hand; the digits at their worst
    com = np.array(reference.COM[2])
    i_link = np.array([82.905, 2903.184, 2924.317, -77.380, -22.366, 0.342])
    weight = np.sqrt([1, 1, 1, 2, 2, 2])

    def implied(com: np.ndarray, link: np.ndarray, at_com: np.ndarray) -> float:
        x, y, z = com
        term = np.array(
            [y * y + z * z, x * x + z * z, x * x + y * y, x * y, x * z, y * z]
        )
        term = term * weight
        return float(term @ ((link - at_com) * weight) / (term @ term))

    at_com = np.array(reference.INERTIA[2])
    middle = implied(com, i_link, at_com)
    rounding = 0.0
    for k in range(3):
        moved_com = com + 5e-4 * np.eye(3)[k]
        rounding += abs(implied(moved_com, i_link, at_com) - middle)
    for k in range(6):
        step = 5e-4 * np.eye(6)[k]
        rounding += abs(implied(com, i_link + step, at_com) - middle)
        rounding += abs(implied(com, i_link, at_com + step) - middle)

    u, q = a5.uncertainty, a5.named_pose("reach")
    torque = u.sensitivity(lambda p: u.arm(p).hydrostatic_torque(q))
    (most, _), *_ = torque.most(1)
    assert most == "link_2.mass"
    return [
        Near(half_width(())),
        Near(half_width(("link2_mass",))),
        Near(middle),
        Near(rounding),
    ]


@statement(
    UNCERTAINTY,
    "is {} N·m with the gearbox's efficiency, and {} N·m with the motor's",
)
def stall_torque() -> Sequence[Figure]:
    """Table 4 by hand: K_t U / R times the gear ratio, U what axis_b needs at its rated
    speed.
    """
    supply = max(0.0116 * 1754.4 * np.radians(30), 0.0545 * 340.4 * np.radians(50))
    motor = 0.0134 * supply / 3.22 * 1754.4
    for eta, efficiency in ((0.86, "gearbox"), (1.0, "motor")):
        ours = a5.actuators.actuator("axis_d", efficiency=efficiency)
        stalled = ours.torque(supply / 3.22, 1e-9)
        friction = 3.752e-3 * 1754.4
        assert stalled == pytest.approx((motor - friction) * eta)
    return [Near(motor * 0.86), Near(motor)]


@statement(UNCERTAINTY, "the interval at most {} times as wide as the exact one")
def bounds_in_motion() -> Sequence[Figure]:
    """For the torque of axis_d; corners are found by a walk along the edges by link."""
    q, v, a = states(6, 8)
    numbers = a5.uncertainty.printed_numbers()
    ours = a5.uncertainty.bounds(q, v, a, a5.load(1000.0, gravity=(1.7, -2.3, -9.4)))
    best = np.zeros((2, 6))
    for i in range(5):
        names = [
            n for n in numbers if n.startswith(f"link_{i}.") and "_link" not in n[7:]
        ]
        names = [n for n in names if not n.endswith((".d", ".a"))]
        middle = {n: numbers[n].value for n in names}

        def value(at: dict[str, float], i: int = i) -> np.ndarray:
            return np.asarray(of_link(i, at, q, v, a, 1000.0)[:, 1])

        rising = {
            n: value({**middle, n: numbers[n].upper})
            - value({**middle, n: numbers[n].lower})
            for n in names
        }
        for side, row in np.ndindex(2, 6):
            at = {
                n: numbers[n].upper
                if (rising[n][row] > 0) == (side == 1)
                else numbers[n].lower
                for n in names
            }
            best[side, row] += value(at)[row]
    wide = ours.torque.upper[:, 1] - ours.torque.lower[:, 1]
    ratio = float((wide / (best[1] - best[0])).max())
    assert ratio >= 1 - 1e-9
    return [AtMost(ratio)]


@statement(
    UNCERTAINTY,
    "| efforts | 3 mN·m | {} % | | load on the mount | 10 mN and mN·m | {} % |",
)
def coverage() -> Sequence[Figure]:
    """The page has 60 trials, here are 8 of each kind.

    The hits within one trial depend on each other, so the error of the mean comes from
    the spread of the trials. If all of them hit, it is not below 5 %.
    """
    u = a5.uncertainty
    time = np.arange(0.0, 12.0, 0.02)
    phase = np.outer(time, [1.25, 1.0, 1.3, 1.1])
    swing = a5.named_pose("reach") + [0, 0.5, -0.6, 0] + 0.4 * np.sin(phase)
    motion = a5.trajectory.motion(time, swing)
    smooth = a5.trajectory.smooth(motion, "interpolate")
    state = smooth.position, smooth.velocity, smooth.acceleration
    trials = 8
    drawn = u.sample(trials, 3)
    rng = np.random.default_rng(1)
    kinds: tuple[list[float], list[float]] = ([], [])
    for k in range(trials):
        p = drawn.parameters(k)
        arm = u.arm(p)
        truth = base_parameters(p.links, parameters=p)[:38]
        effort = arm.inverse_dynamics_batch(*state)
        rows = arm.regressor(*state).matrix
        np.testing.assert_allclose(rows @ truth, effort, atol=1e-9)
        effort = effort + rng.normal(scale=0.003, size=effort.shape)
        load = arm.base_wrench_batch(*state)
        load = load + rng.normal(scale=0.010, size=load.shape)
        by_effort = u.identify(replace(motion, effort=effort), method="interpolate")
        by_load = u.identify(motion, wrench=load, method="interpolate")
        for found, hits in zip((by_effort, by_load), kinds, strict=True):
            inside = (found.lower <= truth) & (truth <= found.upper)
            hits.append(100 * float(inside[found.supported].mean()))
    return [
        Near(
            float(np.mean(hits)),
            max(4 * float(np.std(hits)) / np.sqrt(trials), 5.0),
        )
        for hits in kinds
    ]


# --- the statements ------------------------------------------------------------------


@pytest.mark.slow
@pytest.mark.parametrize("item", parameters_of(__name__))
def test_the_page_says_what_is_computed(item: Statement) -> None:
    item.check()
