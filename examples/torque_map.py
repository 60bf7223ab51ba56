"""A map from a study: the torque that holds the arm, over the reachable half-plane.

python examples/torque_map.py
"""

from __future__ import annotations

from pathlib import Path

import numpy as np

import alpha5_model as a5
from alpha5_model.viewer import figures

HERE = Path(__file__).parent


@figures.style()
def main() -> None:
    """Draw the worst torque at each place, over elbow, wrist, mount and current."""
    found = a5.sweep(HERE / "torque_map.toml", "torque_map").outputs
    x = found["place"]["x"] * 1e3
    z = found["place"]["z"] * 1e3
    torque = found["torque"]
    page = figures.new_figure(9.6, 4.2)
    joints = ("axis_e", "axis_d", "axis_c")
    most = max(torque[joint].max() for joint in joints)
    for axes, joint in zip(page.subplots(1, 3, sharey=True), joints, strict=True):
        cells = {"gridsize": 50, "reduce_C_function": np.max, "vmin": 0.0, "vmax": most}
        worst = torque[joint]
        image = axes.hexbin(x, z, worst, cmap="viridis", linewidths=0.1, **cells)
        k = worst.argmax()
        axes.plot(x[k], z[k], "o", mfc="none", mec=figures.Color.VERMILION, ms=9, mew=2)
        title = f"{joint}: {worst[k]:.2f} N·m"
        axes.set(aspect="equal", xlabel="in front of the yaw axis (mm)", title=title)
    page.axes[0].set_ylabel("height above the base (mm)")
    page.colorbar(image, ax=page.axes, shrink=0.7, label="largest torque at rest (N·m)")
    states = "Whatever wrist, mount and a current of 0.5 m/s"
    page.suptitle(f"{states}: {most:.2f} N·m hold the arm anywhere")
    figures.write_figure(page, "torque_map.png", dpi=110)


if __name__ == "__main__":
    main()
