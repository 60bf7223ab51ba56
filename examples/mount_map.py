"""A map from a study: the largest moment on the mount by its attitude and the payload.

python examples/mount_map.py
"""

from __future__ import annotations

from pathlib import Path

import numpy as np

import alpha5_model as a5
from alpha5_model.viewer import figures

HERE = Path(__file__).parent


@figures.style()
def main() -> None:
    """The mount's moment over roll and pitch, one panel for each payload."""
    moment = a5.sweep(HERE / "mount_map.toml", "mount_map").outputs["moment"]
    names = ("mount_roll", "mount_pitch", "payload_mass")
    roll, pitch, mass = (np.unique(moment[name]) for name in names)
    norm = moment["norm"].reshape(len(roll), len(pitch), len(mass))
    page = figures.new_figure(9.6, 3.2)
    for axes, held, values in zip(
        page.subplots(1, 3, sharey=True), mass, norm.T, strict=True
    ):
        share = 100 * values / values.max()
        levels = np.linspace(80, 100, 11)
        image = axes.contourf(np.degrees(roll), np.degrees(pitch), share, levels)
        title = f"{held:g} kg: up to {values.max():.1f} N·m"
        axes.set(xlabel="roll of the mount (deg)", title=title)
    page.axes[0].set_ylabel("pitch of the mount (deg)")
    page.colorbar(image, ax=page.axes, label="of the panel's largest moment (%)")
    share = (1 - norm.min(axis=(0, 1)) / norm.max(axis=(0, 1))).max()
    factor = norm.max() / norm[..., 0].max()
    page.suptitle(
        f"The attitude changes the largest moment by {share:.0%} at most; "
        f"{mass[-1]:g} kg make it {factor:.1f} times as large"
    )
    figures.write_figure(page, "mount_map.png", dpi=110)


if __name__ == "__main__":
    main()
