"""The arm with a gain in place of its hydraulics, and the simulated experiment on it (section 4.5).

    M(q, masses) q'' + c(q, q', masses) + D q' + S q = K u        (4.1) with the hydraulics a gain

for joints 1 to 6 together, gravity included, the jaw closed. The chromosome (4.19) is
[K, D, S, M_1 ... M_6]; damping and stiffness are the same for all joints. Link shapes and the mass of the
jaw are known; without the jaw every torque would be proportional to the chromosome, and only ratios of its
entries could be found.
"""

from dataclasses import dataclass
from functools import cache
from typing import Any

import numpy as np

from hydrolek_drake.identification.mechanical.arm_bodies import JOINTS, arm_bodies
from hydrolek_drake.identification.mechanical.arm_dynamics import simulate_joints
from hydrolek_drake.physics.bodies.serial_arm import moments_along
from hydrolek_drake.units import si_factor
from hydrolek_drake.yaml_files import package_yaml


@cache
def mechanical_data() -> dict[str, Any]:
    """Content of `mechanical_model.yaml`."""
    return package_yaml(__package__, "mechanical_model.yaml")


@dataclass(frozen=True)
class MechanicalParameters:
    """The nine numbers of the chromosome (4.19), in the units of Table 4.2. # each (9,)."""

    names: tuple[str, ...]
    units: tuple[str, ...]
    initial: np.ndarray
    true: np.ndarray
    lower: np.ndarray
    upper: np.ndarray

    def relative_errors(self, estimate: np.ndarray) -> np.ndarray:
        """|estimate - true| / true, as in Tables 4.2, 4.5 and 4.7. # (9,)."""
        return np.abs(estimate - self.true) / self.true


@cache
def mechanical_parameters() -> MechanicalParameters:
    """Table 4.2 and the ranges."""
    rows = {name: row for name, row in mechanical_data()["parameters"].items() if name != "source"}
    return MechanicalParameters(
        names=tuple(rows),
        units=tuple(str(row["unit"]) for row in rows.values()),
        initial=np.array([float(row["initial"]) for row in rows.values()]),
        true=np.array([float(row["true_value"]) for row in rows.values()]),
        lower=np.array([float(row["range"][0]) for row in rows.values()]),
        upper=np.array([float(row["range"][1]) for row in rows.values()]),
    )


def simulate(chromosome: np.ndarray, command: np.ndarray, sample: float) -> np.ndarray:
    """Angles of joints 1 to 6, from rest at zero.

    Args:
        chromosome: [K, D, S, M_1 ... M_6] in the units of Table 4.2. # (9,)
        command: [V], held over each sample. # (n, 6)
        sample: [s].

    Returns:
        [rad], NaN after a divergence. # (n, 6)
    """
    gain = float(chromosome[0]) * si_factor(mechanical_parameters().units[0], "N m/V")
    damping, stiffness = float(chromosome[1]), float(chromosome[2])
    return simulate_joints(command, sample, gain, damping, stiffness, _links(chromosome))


def holding_voltage(chromosome: np.ndarray) -> np.ndarray:
    """Voltage of each joint that holds the straight arm against gravity [V]. # (6,)."""
    still = np.zeros((1, JOINTS))
    moments = moments_along(_links(chromosome), still, still, still)[0]
    return moments / (float(chromosome[0]) * si_factor(mechanical_parameters().units[0], "N m/V"))


def _links(chromosome: np.ndarray) -> np.ndarray:
    gravity = float(mechanical_data()["gravity"]["value"])
    return arm_bodies().with_masses(np.asarray(chromosome[3:], dtype=float), gravity)


@dataclass(frozen=True)
class MechanicalExperiment:
    """What was commanded and measured.

    Attributes:
        sample: [s].
        command: [V]. # (n, 6)
        angles_deg: measured. # (n, 6)
    """

    sample: float
    command: np.ndarray
    angles_deg: np.ndarray


def simulated_experiment(rng: np.random.Generator, noise_deg: float = 0.0) -> MechanicalExperiment:
    """The 'true' arm of Table 4.2 under random levels of voltage, instead of the thesis's measured data.

    Args:
        rng: draws levels and noise.
        noise_deg: standard deviation of the noise on each angle; 0 as in the thesis.
    """
    plan = mechanical_data()["experiment"]
    sample = float(plan["sample"]["value"])
    count = round(float(plan["duration"]["value"]) / sample)
    held = round(float(plan["dwell"]["value"]) / sample)
    true = mechanical_parameters().true
    amplitude = float(plan["amplitude"]["value"])
    levels = rng.uniform(-amplitude, amplitude, (-(-count // held), JOINTS))
    share = float(plan["holding_share"]["value"])
    command = np.repeat(levels, held, axis=0)[:count] + share * holding_voltage(true)
    angles = np.degrees(simulate(true, command, sample))
    return MechanicalExperiment(sample, command, angles + noise_deg * rng.standard_normal(angles.shape))


@dataclass(frozen=True)
class MechanicalModel:
    """Chromosome -> angles [deg] of chosen joints under an experiment's command; can be sent to workers.

    Attributes:
        command: [V]. # (n, 6)
        sample: [s].
        joints: which angles come out, 0 for joint 1.
    """

    command: np.ndarray
    sample: float
    joints: tuple[int, ...]

    def __call__(self, chromosome: np.ndarray) -> np.ndarray:
        """Angles [deg], NaN after a divergence. # (n, joints)."""
        return np.degrees(simulate(chromosome, self.command, self.sample)[:, list(self.joints)])
