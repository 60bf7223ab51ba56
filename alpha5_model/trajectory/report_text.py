"""The key figures of an analysed motion as lines for a terminal."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

from alpha5_model.trajectory.report import ROUNDING, SLIDING, TURNING
from alpha5_model.trajectory.smoothing import REST_SHARE


def text(record: dict[str, Any]) -> str:
    """The record of `summary` as lines for a terminal."""
    return "\n".join([*_lines(record), *(f"  note: {note}" for note in _notes(record))])


def _lines(record: dict[str, Any]) -> Iterator[str]:
    model, smoothing = record["model"], record["smoothing"]
    width, unit = smoothing["bandwidth_hz"], record["time_unit_of_file"]
    column = "" if unit == "s" else f" (time column in {unit})"
    yield f"{record['source']}: {record['samples']} samples, {record['duration_s']:.2f} s{column}"
    gravity = ", ".join(f"{g:g}" for g in model["gravity"])
    fluid = f"fluid {model['fluid_density']:g} kg/m^3"
    yield f"  model: {model['gripper']} gripper, {fluid}, gravity ({gravity}) m/s^2"
    method = smoothing["method"] + ("" if width is None else f", {width:.3g} Hz (-3 dB)")
    yield f"  smoothing: {method}; derivatives from {smoothing['derivatives_from']}"
    groups = [
        (kind, units, {name: j for name, j in record["joints"].items() if j["units"] == units})
        for kind, units in (("torque", TURNING), ("force", SLIDING))
    ]
    for kind, units, joints in groups:
        if joints:
            yield from _peaks(joints, kind, units)
    for kind, units, joints in groups:
        if joints:
            title = f"  peak {kind} by cause [{units['torque']}]"
            heads = (
                f"{cause.removeprefix('moving_'):>11}"
                for cause in next(iter(joints.values()))["causes_peak"]
            )
            yield f"\n{title:28}" + "".join(heads)
        for name, j in joints.items():
            yield f"  {name:26}" + "".join(map(_cell, j["causes_peak"].values()))
    for kind, units, joints in groups:
        yield from _efforts(joints, kind, units)
    if water := model.get("water_current"):
        yield from _water(record, water)
    energy, mount, tcp = record["energy"], record["mount"], record["tcp"]
    least, most = energy["drawn_interval_j"]
    drawn = f"drawn {energy['drawn_j']:.4g} J ({least:.4g} .. {most:.4g})"
    other = f"fed back {energy['fed_back_j']:.3g} J, mechanical work {energy['mechanical_j']:.3g} J"
    yield f"\n  power: peak {energy['electrical_peak_w']:.3g} W; {drawn}, {other}"
    force, moment = (mount[key]["value"] for key in ("force_peak_n", "moment_peak_nm"))
    yield f"  mount: force up to {force:.4g} N, moment up to {moment:.4g} N m"
    ends = ("first_m", "last_m", "lowest_m", "highest_m")
    first, last, least, most = (_point(tcp[end]) for end in ends)
    length = f"path {tcp['path_length_m']:.4g} m"
    yield f"  TCP: {length}, from {first} to {last} m, within {least} .. {most} m"
    for name, j in record["joints"].items():
        if fast := j["beyond_rated_velocity"]:
            peak, unit = abs(j["velocity_peak"]["value"]), j["units"]["velocity"]
            limit = f"its rated speed of {peak + j['velocity_margin']:.4g} {unit}"
            yield f"  limit: {name} is beyond {limit} in {fast} samples, up to {peak:.4g}"
        if weak := j["beyond_drive_limits"]:
            yield f"  limit: {name} is beyond the speed-torque limit in {weak} samples"
    for w in record["warnings"]:
        yield f"  warning: {w['text']}: {w['count']} x, first: {w['first']}"


def _water(record: dict[str, Any], current: list[float]) -> Iterator[str]:
    """Peaks of what moving water adds, with the interval of its numbers."""
    speed = ", ".join(f"{x:g}" for x in current)
    yield f"\n  water: current ({speed}) m/s; estimated, not published; peak, and with all numbers low .. high"
    found = {
        name: (j["moving_water_peak"], j["units"]["torque"]) for name, j in record["joints"].items()
    }
    mount = record["mount"]
    found["mount"] = mount["water_force_peak_n"], "N"
    found[""] = mount["water_moment_peak_nm"], "N m"
    for name, (peak, unit) in found.items():
        low, high = peak["interval"]
        yield f"  {name:7} {peak['value']:+14.4g} {low:+14.4g} .. {high:+.4g} {unit}"


def _peaks(joints: dict[str, Any], kind: str, units: dict[str, str]) -> Iterator[str]:
    """Peaks and margins of joints that share their units."""
    force, speed = f"{kind} [{units['torque']}]", f"speed [{units['velocity']}]"
    head = f"\n  joint  {force:>15}  margin   current [A], interval     margin {speed:>14}  margin "
    yield head + f"range margin [{units['position']}]".rjust(20)
    for name, j in joints.items():
        current = "       (needs --screw-lead)   "
        if peak := j["current_peak"]:
            low, high = peak["interval"]
            current = f"{peak['value']:+8.3f}  {low:+.3f} .. {high:+.3f}"
        left = "      -" if j["current_margin"] is None else f"{j['current_margin']:+7.3f}"
        yield (
            f"  {name:7} {j['torque_peak']['value']:+14.4g} {j['torque_margin']:7.4g} "
            f"  {current:26} {left} {j['velocity_peak']['value']:+14.4g} "
            f"{j['velocity_margin']:+7.3g} {j['position_margin']:+20.4g}"
        )


def _efforts(joints: dict[str, Any], kind: str, units: dict[str, str]) -> Iterator[str]:
    """Recorded efforts of joints that share their units, against what was computed."""
    found = {name: j["effort"] for name, j in joints.items() if j.get("effort")}
    if found:
        title = f"  recorded effort, less {kind} [{units['torque']}]"
        heads = ("effort rms", "mean", "peak", "rms", "less friction", "correlation")
        yield f"\n{title:36}" + "".join(f"{head:>14}" for head in heads)
    for name, e in found.items():
        mean, peak = e["difference_mean"], e["difference_peak"]["value"]
        rest = (e["difference_rms"], e["difference_rms_with_friction"], e["correlation"])
        cells = "".join(f"{'-' if x is None else format(x, '.4g'):>14}" for x in rest)
        yield f"  {name:34}{e['rms']:14.4g}{mean:+14.4g}{peak:+14.4g}{cells}"


def _notes(record: dict[str, Any]) -> Iterator[str]:
    motors, left = record["motors"], record["energy"]["contradiction_j"]
    yield (
        f"a joint slower than {REST_SHARE:.1%} of its rated speed counts as at rest: friction holds it and "
        "its motor needs the least current that keeps it there"
    )
    yield "torque is what the joint must carry; friction, at the motor, is a cause of its own and in the current"
    yield "torque margins are to an effort of 9 N m (jaw rod 10 N) that every public model copies; no rating is published"
    ratios = ", ".join(f"{name} {r:.3f}" for name, r in motors["constants_ratio"].items())
    used = motors["constants"]
    if used == "printed":
        used += f", which leaves {left:+.3g} J of the electrical energy unexplained"
    yield f"Table 4's K_t and K_v contradict each other (K_t/K_v: {ratios}); used here: {used}"
    if motors["supply_voltage"] is None:
        yield "current margins need --supply-voltage and --current-limit; neither is published"


def _cell(value: float | None) -> str:
    return f"{'-':>11}" if value is None else f"{0.0 if value < ROUNDING else value:11.4g}"


def _point(position: list[float]) -> str:
    # Adding zero turns the -0.0 of rounding into 0.0.
    return "(" + ", ".join(f"{round(x, 3) + 0.0:.3f}" for x in position) + ")"
