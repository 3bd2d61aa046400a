"""Inverse dynamics: the motor's force regressed on acceleration, speed, its sign, and what holds against gravity.

    F = I a + D v + F_c sign(v) + F_0                        a sliding load
    F = I a + D v + F_c sign(v) + g_c cos q + g_s sin q      a turning one, equation (4.1)

with position low-passed forwards and backwards, differentiated, and both sides low-passed alike before samples are
left out (Gautier, Venture, Identification of standard dynamic parameters of robots, IEEE IROS 2013; Janot, Gautier,
Brunot, Data set and reference models of EMPS, 2019). Unlike a fit of the simulated position it does not integrate what
the model lacks, but it needs the drive's force and a position fine enough to be differentiated twice.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from scipy.signal import butter, decimate, filtfilt
from scipy.stats import norm

from hydrolek_drake.errors import InputError
from hydrolek_drake.physics.command import drive_voltage
from hydrolek_drake.physics.cylinder import FORCED, motor_force
from hydrolek_drake.physics.load import reflected_rod_inertia
from hydrolek_drake.recordings import Recording, require
from hydrolek_drake.replay.readings import measured_position
from hydrolek_drake.rigs import Rig

ORDER = 4
"""Of the Butterworth low-pass."""

CONFIDENCE = 0.95

AT_REST = 3.0
"""Below so many standard deviations of its noise a speed is none."""

ROUNDING = 1e-3
"""Of a sample: a command that is set this little after an instant is in force at it."""


@dataclass(frozen=True)
class Regression:
    """What came out.

    Attributes:
        joint: its name.
        paths: full paths of the parameters.
        values: (SI). # (n,)
        errors: standard errors, widened by the correlation of neighbouring residuals. # (n,)
        time: of the equations, recording after recording [s]. # (k,) each
        force: that drove the joint, low-passed [N or N m]. # (k,) each
        model: what the regression makes of it. # (k,) each
        correlation: of a residual with its neighbour.
    """

    joint: str
    paths: tuple[str, ...]
    values: np.ndarray
    errors: np.ndarray
    time: tuple[np.ndarray, ...]
    force: tuple[np.ndarray, ...]
    model: tuple[np.ndarray, ...]
    correlation: float

    @property
    def misfit(self) -> float:
        """Rms of the residuals over that of the force."""
        force, model = np.concatenate(self.force), np.concatenate(self.model)
        return float(np.sqrt(np.mean((force - model) ** 2) / np.mean(force**2)))

    def intervals(self) -> dict[str, tuple[float, float, float]]:
        """Full path -> value and 95 % interval (SI)."""
        half = float(norm.ppf(0.5 + 0.5 * CONFIDENCE)) * self.errors
        rows = zip(self.paths, self.values, self.values - half, self.values + half, strict=True)
        return {path: (float(value), float(low), float(high)) for path, value, low, high in rows}


def motor_joint(rig: Rig) -> str:
    """The motor-driven joint of a rig.

    Raises:
        InputError: several joints, or one driven by oil.
    """
    if len(rig.joints) != 1:
        raise InputError(
            f"rig {rig.name} has {len(rig.joints)} joints; a force regression takes one at a time"
        )
    (joint,) = rig.joints
    drive = rig.variant(joint, "cylinder")
    if drive not in FORCED:
        raise InputError(
            f"rig {rig.name}: {joint} is driven by a '{drive}'; the force is known of an 'electric_motor' or a "
            "'ball_screw' alone, so use hydrolek fit"
        )
    return joint


def inverse_dynamics(
    rig: Rig, recordings: Sequence[Recording], *, cutoff_Hz: float = 60.0, decimation: int = 20
) -> Regression:
    """Regress the drive's force.

    Args:
        rig: of one motor-driven joint; what its drive makes of a command is taken as known.
        recordings: with command and position, regressed together.
        cutoff_Hz: of the low-pass on the position.
        decimation: samples to one equation.

    Raises:
        InputError: a rig without motor, a recording without what is needed, too short or standing still, or a cutoff
            beyond half the sampling frequency.
    """
    joint = motor_joint(rig)
    parts = [_equations(rig, joint, recording, cutoff_Hz, decimation) for recording in recordings]
    paths = _paths(rig, joint)
    matrix = np.concatenate([columns for _, columns, _ in parts])
    force = np.concatenate([wanted for _, _, wanted in parts])
    size = np.linalg.norm(matrix, axis=0)
    if len(force) <= len(paths) or np.linalg.matrix_rank(matrix / np.where(size > 0.0, size, 1.0)) < len(
        paths
    ):
        raise InputError(
            f"{recordings[0].source}: the motion does not tell {', '.join(paths)} apart; record longer, in both "
            "directions and at several speeds"
        )
    values = np.linalg.lstsq(matrix / size, force, rcond=None)[0] / size
    models = [columns @ values for _, columns, _ in parts]
    residuals = [wanted - model for (_, _, wanted), model in zip(parts, models, strict=True)]
    together = np.concatenate(residuals)
    correlation = float(np.clip(_neighbours(residuals), 0.0, 0.99))
    # of equations whose residuals are like a first-order process only so many count (Bayley, Hammersley 1946)
    variance = together @ together / (len(together) - len(paths)) * (1.0 + correlation) / (1.0 - correlation)
    errors = np.sqrt(variance * np.diag(np.linalg.inv((matrix / size).T @ (matrix / size)))) / size
    return Regression(
        joint,
        paths,
        values,
        errors,
        tuple(time for time, _, _ in parts),
        tuple(wanted for _, _, wanted in parts),
        tuple(models),
        correlation,
    )


def _paths(rig: Rig, joint: str) -> tuple[str, ...]:
    where = f"joints.{joint}"
    common = (
        f"{where}.load.inertia",
        f"{where}.load.damping",
        f"{where}.effects.load.coulomb_friction.force_N",
    )
    if rig.variant(joint, "load") == "sliding":
        return (*common, f"{where}.effects.load.offset_force.force_N")
    return (*common, f"{where}.load.gravity_cos", f"{where}.load.gravity_sin")


def _equations(
    rig: Rig, joint: str, recording: Recording, cutoff_Hz: float, decimation: int
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Times # (k,), columns # (k, n) and force # (k,) of one recording."""
    key = f"{joint}.command"
    require(recording, [], complete=[key], units={key: "V"})
    place = np.asarray(measured_position(rig, joint, recording), dtype=float)
    if not np.isfinite(place).all():
        raise InputError(
            f"{recording.source}: the position of {joint} has no value at "
            f"{recording.time[int(np.argmin(np.isfinite(place)))]:.9g} s; cut the recording to a part that has it"
        )
    step = float(np.median(np.diff(recording.time)))
    if not 0.0 < cutoff_Hz < 0.5 / step:
        raise InputError(
            f"--cutoff {cutoff_Hz:g}: {recording.source} is sampled with {1.0 / step:.4g} Hz; choose less than half"
        )
    if decimation < 1 or place.size < 30 * decimation:
        raise InputError(
            f"--decimation {decimation}: {recording.source} has {place.size} samples; choose 1 to {place.size // 30}"
        )
    times = np.linspace(recording.time[0], recording.time[-1], round(recording.duration / step) + 1)
    step = float(times[1] - times[0])
    q = np.interp(times, recording.time, place)
    record = rig.records()[0]
    delay = rig.value(f"joints.{joint}.command.delay")
    held = np.maximum(np.searchsorted(recording.time, times - delay + ROUNDING * step, side="right") - 1, 0)
    volts = np.array([drive_voltage(float(u), record) for u in recording.signal(key)[held]])
    direction = rig.value(f"joints.{joint}.linkage.direction")
    force = direction * np.array([motor_force(float(u), record) for u in volts])
    # forwards and backwards, so that position, speed and acceleration are not delayed
    smooth = filtfilt(*butter(ORDER, 2.0 * cutoff_Hz * step), q)
    speed = np.gradient(smooth, step)
    acceleration = np.gradient(speed, step)
    force = force - reflected_rod_inertia(record) * acceleration  # what the motor's own parts take
    columns = [acceleration, speed, np.sign(speed)]
    if rig.variant(joint, "load") == "sliding":
        force = force - rig.value(f"joints.{joint}.load.gravity_cos")
        columns.append(np.ones_like(speed))
    else:
        columns += [np.cos(smooth), np.sin(smooth)]
    if decimation > 1:  # the same low-pass on both sides of the equation keeps it true
        *columns, force, times = (
            *(decimate(c, decimation, ftype="fir") for c in (*columns, force)),
            times[::decimation],
        )
    load = f"joints.{joint}.load"
    at = smooth[::decimation]
    inside = (at > rig.value(f"{load}.lower_stop")) & (at < rig.value(f"{load}.upper_stop"))
    # at rest dry friction is whatever holds, and the noise of the position says which way it moves
    noise = rig.value(f"joints.{joint}.sensor.noise")
    inside &= np.abs(speed[::decimation]) > AT_REST * _noise_of_speed(noise, cutoff_Hz, step)
    inside &= (
        times >= recording.time[0] + delay
    )  # before that, what drives was commanded before the recording
    return times[inside], np.stack(columns, axis=1)[inside], force[inside]


def _noise_of_speed(noise: float, cutoff_Hz: float, step: float) -> float:
    """Standard deviation of a speed from a position with white noise, low-passed: sqrt(2 h int (2 pi f)^2 df) noise."""
    return noise * 2.0 * math.pi * math.sqrt(2.0 * step * cutoff_Hz**3 / 3.0)


def _neighbours(residuals: Sequence[np.ndarray]) -> float:
    """Correlation of each residual with the next."""
    product = sum(float(r[1:] @ r[:-1]) for r in residuals)
    return product / sum(float(r @ r) for r in residuals)
