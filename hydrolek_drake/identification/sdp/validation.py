"""Validation of an SDP model under random voltage, as in section 6.1.4 and Table 6.2."""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from hydrolek_drake.control.models.sdp_model import SdpModel
from hydrolek_drake.identification.sdp.step_test import campaign_data

KINDS = ("limited amplitude", "limited amplitude and dead-band")


@dataclass(frozen=True)
class ValidationRun:
    """One run of one kind.

    Attributes:
        kind: of `KINDS`.
        voltage_V: # (n,)
        machine_deg: # (n,)
        model_deg: # (n,)
    """

    kind: str
    voltage_V: np.ndarray
    machine_deg: np.ndarray
    model_deg: np.ndarray

    @property
    def mean_squared_error(self) -> float:
        """[deg^2], as in Table 6.2."""
        return float(np.mean((self.machine_deg - self.model_deg) ** 2))


def random_voltage(kind: str, model: SdpModel, rng: np.random.Generator) -> np.ndarray:
    """Random levels, each held for a random time, that keep the joint out of saturation [V]. # (n,).

    Args:
        kind: the second of `KINDS` has no level within the dead-zone of section 6.1.4.
        model: says where saturation begins.
        rng: draws levels and times.
    """
    plan = campaign_data()["validation"]
    share = float(plan["share_of_saturation"]["value"])
    slowest, fastest = model.saturation_deg_per_s
    lowest, highest = model.voltage_at(share * slowest), model.voltage_at(share * fastest)
    band = float(plan["dead_band_V"]["value"]) if kind == KINDS[1] else 0.0
    shortest, longest = map(float, plan["dwell"]["value"])
    count = round(float(plan["duration"]["value"]) / model.sample_s)
    voltage = np.empty(count)
    at = 0
    while at < count:
        level = rng.uniform(lowest, highest)
        if abs(level) < band:
            continue
        until = at + max(round(rng.uniform(shortest, longest) / model.sample_s), 1)
        voltage[at:until] = level
        at = until
    return voltage


def validate(
    model: SdpModel,
    machine: Callable[[np.ndarray, float, float, np.random.Generator], np.ndarray],
    rng: np.random.Generator,
) -> list[ValidationRun]:
    """Three runs of five minutes of each kind, from the middle of the range.

    Args:
        model: to be judged.
        machine: voltage, sample [s], start [deg], random numbers -> angle [deg].
        rng: random numbers.
    """
    start = 0.5 * (model.lower_deg + model.upper_deg)
    runs = []
    for kind in KINDS:
        for _ in range(int(campaign_data()["validation"]["runs"]["value"])):
            voltage = random_voltage(kind, model, rng)
            runs.append(
                ValidationRun(
                    kind,
                    voltage,
                    machine(voltage, model.sample_s, start, rng),
                    model.simulate(voltage, start),
                )
            )
    return runs
