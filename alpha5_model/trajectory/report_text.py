"""The key figures of an analysed motion as lines to be read."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from typing import Any

from alpha5_model.text import readable, table
from alpha5_model.trajectory.report import ROUNDING, SLIDING, TURNING
from alpha5_model.trajectory.smoothing import REST_SHARE


def text(record: dict[str, Any]) -> str:
    """The record of `summary` as lines for a terminal; tables fit 80 columns."""
    lines = [*_lines(record), *(f"  note: {note}" for note in _notes(record))]
    return readable("\n".join(lines))


def _lines(record: dict[str, Any]) -> Iterator[str]:
    model, smoothing, joints = record["model"], record["smoothing"], record["joints"]
    width, unit = smoothing["bandwidth_hz"], record["time_unit_of_file"]
    column = "" if unit == "s" else f" (time column in {unit})"
    yield f"{record['source']}: {record['samples']} samples, {record['duration_s']:.2f} s{column}"
    gravity = ", ".join(f"{round(g, 9) + 0.0:g}" for g in model["gravity"])
    fluid = f"fluid {model['fluid_density']:g} kg/m^3"
    yield f"  model: {model['gripper']} gripper, {fluid}, gravity ({gravity}) m/s^2"
    method = smoothing["method"] + ("" if width is None else f", {width:.3g} Hz (-3 dB)")
    yield f"  smoothing: {method}; derivatives from {smoothing['derivatives_from']}"
    heads = {"torque": "torque", "current": "A", "by friction's tolerance": "A"}
    heads["speed"] = "velocity"
    yield from _by_joint("peaks", joints, heads, _peaks)
    peaks = [j["torque_peak"].get("interval") for j in [*joints.values()][:4]]
    if all(peaks):
        halves = ", ".join(f"{(high - low) / 2:.1g}" for low, high in peaks)
        yield f"  digits of Tables 2, 3: torque peaks ±({halves}) N m"
    heads = {"torque": "torque", "current": "A", "speed": "velocity", "range": "position"}
    yield from _by_joint("left to the limits, negative beyond them", joints, heads, _left)
    causes = next(iter(joints.values()))["causes_peak"]
    heads = {cause.removeprefix("moving_"): "torque" for cause in causes}
    yield from _by_joint("largest torque by cause", joints, heads, _causes)
    heads = dict.fromkeys(("effort rms", "mean", "peak", "rms", "less friction"), "torque")
    recorded = {name: j for name, j in joints.items() if j.get("effort")}
    if recorded:
        heads["correlation"] = ""
        yield from _by_joint(
            "recorded effort, and what it has more than the torque", recorded, heads, _effort
        )
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
    yield f"  TCP: {length}, from {first} to {last} m,"
    yield f"       within {least} .. {most} m"
    for name, j in joints.items():
        if fast := j["beyond_rated_velocity"]:
            peak, unit = abs(j["velocity_peak"]["value"]), j["units"]["velocity"]
            limit = f"its rated speed of {peak + j['velocity_margin']:.4g} {unit}"
            yield f"  limit: {name} is beyond {limit} in {fast} samples, up to {peak:.4g}"
        if weak := j["beyond_drive_limits"]:
            yield f"  limit: {name} is beyond the speed-torque limit in {weak} samples"
    for w in record["warnings"]:
        yield f"  warning: {w['text']}: {w['count']} x, first: {w['first']}"


def _by_joint(
    title: str,
    joints: dict[str, Any],
    heads: dict[str, str],
    cells: Callable[[dict[str, Any]], Sequence[str]],
) -> Iterator[str]:
    """A table of joints, the jaw rod under its units; ``heads`` are column -> unit or quantity."""
    yield f"\n  {title}"
    rows = [["", *heads]]
    for units in (TURNING, SLIDING):
        group = {name: j for name, j in joints.items() if j["units"] == units}
        rows += [["", *(units.get(unit, unit) for unit in heads.values())]] if group else []
        rows += [[name, *cells(j)] for name, j in group.items()]
    yield from table(rows, "<>", 2)


def _peaks(j: dict[str, Any]) -> list[str]:
    current = ["needs --screw-lead", ""]
    if peak := j["current_peak"]:
        low, high = peak["interval"]
        current = [f"{peak['value']:+.3f}", f"{low:+.3f} .. {high:+.3f}"]
    return [f"{j['torque_peak']['value']:+.4g}", *current, f"{j['velocity_peak']['value']:+.4g}"]


def _left(j: dict[str, Any]) -> list[str]:
    current = "-" if j["current_margin"] is None else f"{j['current_margin']:+.3f}"
    speed, span = f"{j['velocity_margin']:+.3g}", f"{j['position_margin']:+.4g}"
    return [f"{j['torque_margin']:.4g}", current, speed, span]


def _causes(j: dict[str, Any]) -> list[str]:
    peaks = j["causes_peak"].values()
    return ["-" if x is None else f"{0.0 if x < ROUNDING else x:.4g}" for x in peaks]


def _effort(j: dict[str, Any]) -> list[str]:
    e = j["effort"]
    mean, peak = e["difference_mean"], e["difference_peak"]["value"]
    rest = (e["difference_rms"], e["difference_rms_with_friction"], e["correlation"])
    cells = ("-" if x is None else format(x, ".4g") for x in rest)
    return [f"{e['rms']:.4g}", f"{mean:+.4g}", f"{peak:+.4g}", *cells]


def _water(record: dict[str, Any], current: list[float]) -> Iterator[str]:
    """Peaks of what moving water adds, with the interval of its numbers."""
    speed = ", ".join(f"{x:g}" for x in current)
    yield f"\n  water: current ({speed}) m/s; estimated, not published"
    found = [(n, j["moving_water_peak"], j["units"]["torque"]) for n, j in record["joints"].items()]
    mount = record["mount"]
    found.append(("mount", mount["water_force_peak_n"], "N"))
    found.append(("", mount["water_moment_peak_nm"], "N m"))
    rows = [["", "peak", "all numbers low .. high", ""]]
    for name, peak, unit in found:
        low, high = peak["interval"]
        rows.append([name, f"{peak['value']:+.4g}", f"{low:+.4g} .. {high:+.4g}", unit])
    yield from table(rows, "<>><", 2)


def _notes(record: dict[str, Any]) -> Iterator[str]:
    motors, left = record["motors"], record["energy"]["contradiction_j"]
    yield (
        f"below {REST_SHARE:.1%} of its rated speed a joint is at rest: friction holds it, its motor "
        "helps with the least current"
    )
    yield "friction, at the motor, is a cause of its own; it is in the current, not in the torque"
    yield "torque limits are the 9 N m (jaw rod 10 N) of every public model; no rating is published"
    ratios = ", ".join(f"{name} {r:.3f}" for name, r in motors["constants_ratio"].items())
    used = motors["constants"]
    if used == "printed":
        used += f", which leaves {left:+.3g} J of the electrical energy unexplained"
    yield f"Table 4's constants contradict each other (K_t/K_v: {ratios}); used here: {used}"
    if motors["supply_voltage"] is None:
        yield "current limits need --supply-voltage and --current-limit; neither is published"


def _point(position: list[float]) -> str:
    # Adding zero turns the -0.0 of rounding into 0.0.
    return "(" + ", ".join(f"{round(x, 3) + 0.0:.3f}" for x in position) + ")"
