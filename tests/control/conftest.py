"""Feedforward laws for the SDP models of the thesis, changed models, and laws whose states are kept."""

from collections.abc import Callable
from dataclasses import replace

import pytest

from hydrolek_drake.control.laws.feedforward import FeedforwardLaw
from hydrolek_drake.control.laws.feedforward_tuning import tuning
from hydrolek_drake.control.laws.rate_map import map_from_model
from hydrolek_drake.control.models.sdp_model import SdpModel, thesis_model


@pytest.fixture(scope="session")
def modelled() -> Callable[[str], tuple[FeedforwardLaw, SdpModel]]:
    """Joint -> its law and the model that this was made for."""

    def made(joint: str) -> tuple[FeedforwardLaw, SdpModel]:
        model = thesis_model(joint)
        return FeedforwardLaw(map_from_model(model), 0.05, 10.0, tuning()), model

    return made


@pytest.fixture(scope="session")
def changed() -> Callable[..., SdpModel]:
    """The same joint with more samples of delay, and a dead-zone wider by a factor, its curve shifted outwards."""

    def made(model: SdpModel, *, extra_delay: int = 0, wider: float = 1.0) -> SdpModel:
        a = list(model.alpha)
        a[2], a[5] = a[2] * wider, a[5] * wider
        return replace(model, alpha=tuple(a), delay_samples=model.delay_samples + extra_delay)

    return made


class _Recorded:
    """A law whose states are kept, by name."""

    def __init__(self, law):
        self.law, self.size, self.states = law, law.size, []

    def initial(self, measured_deg):
        return self.law.initial(measured_deg)

    def step(self, state, set_point_deg, measured_deg):
        found = self.law.step(state, set_point_deg, measured_deg)
        self.states.append(self.law.memory(found[0]))
        return found


@pytest.fixture(scope="session")
def recorded() -> type[_Recorded]:
    """Wraps a law."""
    return _Recorded
