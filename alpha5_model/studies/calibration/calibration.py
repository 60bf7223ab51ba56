"""The result of a calibration, and the function that makes it."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass

import numpy as np

from alpha5_model._support.checks import FloatArray, instance, listed, real
from alpha5_model._support.files import PathLike
from alpha5_model._support.writing import atomic_write
from alpha5_model.errors import InputError
from alpha5_model.numbers.arm_writing import arm_file_text
from alpha5_model.numbers.parameters import Alpha5Parameters, chosen_arm
from alpha5_model.numbers.tables import JOINT_NAMES
from alpha5_model.studies.calibration.equations import Equations
from alpha5_model.studies.calibration.fitting import (
    Estimate,
    calibrated_arm,
    estimate,
)
from alpha5_model.studies.calibration.loads import Motion, load_slopes
from alpha5_model.studies.calibration.poses import TILT
from alpha5_model.studies.calibration.problems import Problem, problems
from alpha5_model.studies.calibration.sessions import Session
from alpha5_model.studies.calibration.unknowns import (
    NAMES,
    ArmUnknowns,
    arm_unknowns,
)

#: Random poses over which the remaining torque is averaged.
_POSES = 200
#: A number is said to be learnt if its standard deviation shrinks below this share.
_LEARNT = 0.5


@dataclass(frozen=True, eq=False)
class Calibration:
    """What measurements say of an arm. `print` shows the problems first.

    Attributes:
        arm: Its record, with half widths (sqrt(3) standard deviations) and covariance.
        problems: What the readings contradict, the likeliest first; see `Problem`.
            Believe the arm only if there are none.
        names: Of the numbers that were unknown, (K,), by their keys in an arm file.
        estimate: Their values, SI units, (K,); zeros as in the arm file.
        prior, deviation: Their standard deviations before and after, (K,).
        other_names, other_estimate, other_deviation: The same of tilts, gains, offsets
            and so on, each with the number of its session, (n,).
        squared: Least sum of squared misfits and changes, each in standard deviations;
            near ``readings`` if the model holds.
        readings: Number of readings.
        density: Of the fluid of the next two [kg/m^3].
        torque_before, torque_after: Standard deviation of the torques that hold the arm
            still at reported joint positions, averaged over poses, (4,) [N m].
    """

    arm: Alpha5Parameters
    problems: tuple[Problem, ...]
    names: tuple[str, ...]
    estimate: FloatArray
    prior: FloatArray
    deviation: FloatArray
    other_names: tuple[str, ...]
    other_estimate: FloatArray
    other_deviation: FloatArray
    squared: float
    readings: int
    density: float
    torque_before: FloatArray
    torque_after: FloatArray

    def text(self) -> str:
        """The arm file."""
        notes = [f"problem {one.rank}: {one}" for one in self.problems]
        return arm_file_text(self.arm, notes)

    def write(self, path: PathLike) -> None:
        """Write the arm file, which `alpha5_model.arm_file` reads.

        Raises:
            OutputError: It cannot be written.
        """
        atomic_write(path, self.text())

    def __str__(self) -> str:
        lines = [f"problem {one.rank}: {one}" for one in self.problems]
        if self.problems:
            lines.append("")
        lines.append(
            f"{self.readings} readings, squared misfit {self.squared:.4g} "
            f"({self.readings} expected)"
        )
        fluid = f"fluid of {self.density:g} kg/m^3"
        lines.append(f"torque that holds the arm, one standard deviation, {fluid}")
        rows = zip(
            JOINT_NAMES, 1e3 * self.torque_before, 1e3 * self.torque_after, strict=False
        )
        for joint, before, after in rows:
            lines.append(f"  {joint}: {before:.3f} -> {after:.3f} mN m")
        lines.append("learnt most")
        for name, value, before, after in self._learnt():
            lines.append(f"  {name}: {value:.6g} ± {after:.2g} (before {before:.2g})")
        return "\n".join(lines)

    def _learnt(self) -> list[tuple[str, float, float, float]]:
        """Numbers that the readings tell, those that they tell best first."""
        share = self.deviation / self.prior
        order = [k for k in np.argsort(share, kind="stable") if share[k] < _LEARNT]
        return [
            (
                self.names[k],
                float(self.estimate[k]),
                float(self.prior[k]),
                float(self.deviation[k]),
            )
            for k in order
        ]


def fit(
    sessions: Session | Iterable[Session],
    *,
    arm: Alpha5Parameters | None = None,
    prior: str = "digits",
    zeros: float = np.radians(1.0),
    tilt: float = TILT,
) -> Calibration:
    """Fit an arm's bodies, zeros and lengths to readings.

    The result is the most probable arm: the least sum of squares of the readings'
    misfits and of the changes from what was known before, each in standard deviations.
    Tilt of the mount, gains, offsets and places of the sensor are unknown in each
    session. The bodies found are physically possible, and their centres of mass lie
    within the bounds.

    Args:
        sessions: From `session` or `read_session`; for example one in air and one in
            water.
        arm: Record of the arm before; None for the catalogue's.
        prior: ``digits``: its numbers are as good as their printed digits, or as the
            half widths of its file. ``loose``: masses and volumes are known to 10 %,
            centres to 5 mm, one standard deviation each.
        zeros: Standard deviation of the zeros of the joints [rad].
        tilt: That of the tilt of the mount about two axes [rad].

    Raises:
        InputError: Nothing is read, or the arm is calibrated already.
        UnknownNameError: No such prior.
    """
    given = [sessions] if isinstance(sessions, Session) else sessions
    measured = [
        instance("sessions", one, Session)
        for one in listed("sessions", given, "sessions")
    ]
    if not any(one.is_read for one in measured):
        expected = "at least one session with readings"
        raise InputError("sessions", [one.name for one in measured], expected)

    moving = not all(one.motion.rests for one in measured)
    unknowns = arm_unknowns(chosen_arm(arm), prior, zeros, moving)
    spread = real("tilt", tilt, minimum=0.0)
    equations = Equations(unknowns=unknowns, sessions=measured, tilt=spread)
    found = estimate(equations)
    return _calibration(equations, found)


def _calibration(equations: Equations, found: Estimate) -> Calibration:
    """The record of an estimate."""
    unknowns = equations.unknowns
    deviation = found.deviation(equations.deviation)
    free = np.flatnonzero(equations.deviation)
    of_arm = free[free < len(NAMES)]
    others = free[free >= len(NAMES)]
    sessions = equations.sessions
    before, after = _torques(unknowns, found, sessions[-1])
    sources = [f"{one.sensor.kind}, {one.name}" for one in sessions]
    return Calibration(
        arm=calibrated_arm(unknowns, found, sources),
        problems=problems(equations, found),
        names=tuple(equations.names[k] for k in of_arm),
        estimate=found.values[of_arm],
        prior=equations.deviation[of_arm],
        deviation=deviation[of_arm],
        other_names=tuple(equations.names[k] for k in others),
        other_estimate=found.values[others],
        other_deviation=deviation[others],
        squared=found.squared,
        readings=found.readings,
        density=sessions[-1].density,
        torque_before=before,
        torque_after=after,
    )


def _torques(
    unknowns: ArmUnknowns, found: Estimate, session: Session
) -> tuple[FloatArray, FloatArray]:
    """Standard deviations of static torques, root mean square over poses, (4,) each."""
    joints = unknowns.arm.joints[:4]
    lower = np.array([joint.lower for joint in joints])
    upper = np.array([joint.upper for joint in joints])
    q = np.random.default_rng(0).uniform(lower, upper, (_POSES, 4))
    still = np.zeros_like(q)
    motion = Motion(q=q, v=still, a=still, gravity=session.motion.gravity)
    values = found.values[: len(NAMES)]
    slopes = load_slopes(unknowns, values, session.density, motion)[:, :4]
    scaled = slopes * unknowns.deviation
    before = (scaled**2).sum(axis=-1)
    told = ((scaled @ found.factor[: len(NAMES)]) ** 2).sum(axis=-1)
    after = np.maximum(before - told, 0.0)
    return np.sqrt(before.mean(axis=0)), np.sqrt(after.mean(axis=0))
