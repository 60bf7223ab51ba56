"""Good texts of files, to be damaged."""

from __future__ import annotations

JOINTS = tuple(f"axis_{x}" for x in "edcb")

STUDY = """
seed = 7
samples = 10
[axes]
axis_e_pos = 0.1
axis_d_pos = {random = [0, 200], unit = "deg"}
axis_c_pos = {values = [0.3, 1.7]}
axis_b_pos = {from = 0, to = 1, count = 3}
payload_mass = {values = [0, 250], unit = "g"}
fluid_density = [1000, 1025]
level = ["low", "high"]
vehicle = "small"
trim = [true, false]
[vehicles.small]
mass = 13.5
com = [0.0, 0.0, 0.0]
volume = 0.0134
cob = [0.0, 0.0, 0.01]
rpy = [3.1, 0.0, 0.0]
[outputs.peak]
quantity = "torque"
as = "peak"
by = ["fluid_density"]
[outputs.spread]
quantity = "torque"
as = "quantile"
levels = [0.001, 0.5, 1]
"""
OBSTACLES = """
[hull]
box = [0.457, 0.338, 0.254]
xyz = [-0.2, 0.0, -0.14]
rpy = [0.0, 0.0, 0.1]
[post]
cylinder = [0.03, 1.0]
xyz = [0.4, 0.1, 0.0]
[frame]
mesh = "frame.stl"
scale = 0.001
"""
#: Keys of an arm file that its template shows as comments only.
ARM = """
format = 1
name = "lab"
[links.link_2]
mass = {value = 341, unit = "g", source = "weighed", half_width = 1}
[[attached]]
name = "force_sensor"
link = "link_4"
at = {value = [0, 0, -75], unit = "mm"}
spacer = {value = 22, unit = "mm"}
mass = {value = 120, unit = "g"}
volume = {value = 0.045, unit = "L"}
"""


def table() -> str:
    rows = [f"{k * 0.05:.2f},{3 + 0.01 * k},1.{k:02d},1,0.5" for k in range(12)]
    return "\n".join(["time_secs," + ",".join(f"{j}_pos" for j in JOINTS), *rows])
