"""Every controller by name, built for any joint of which an SDP model is known."""

from collections.abc import Callable
from dataclasses import dataclass
from functools import cache
from typing import Any

from hydrolek_drake.control.design import integrator, lq_gains
from hydrolek_drake.control.laws.feedforward import FeedforwardLaw
from hydrolek_drake.control.laws.feedforward_tuning import tuning
from hydrolek_drake.control.laws.forward_path import ForwardPathLaw
from hydrolek_drake.control.laws.fuzzy import (
    SingleInputFuzzyLaw,
    TwoInputFuzzyLaw,
    appendix_f_surface,
    printed_surface,
)
from hydrolek_drake.control.laws.guard import GuardedLaw, guarded
from hydrolek_drake.control.laws.inverse_dead_zone import InverseDeadZone, inverse_dead_zone
from hydrolek_drake.control.laws.law import ControlLaw
from hydrolek_drake.control.laws.pi import PiLaw
from hydrolek_drake.control.laws.pid import PidLaw
from hydrolek_drake.control.laws.pip import PipLaw
from hydrolek_drake.control.laws.rate_control import RateLaw
from hydrolek_drake.control.laws.rate_map import RateMap, map_from_model, rig_model_and_rates
from hydrolek_drake.control.laws.scaled_input import DirectInput, ScaledInput
from hydrolek_drake.control.models.sdp_model import SdpModel, thesis_model
from hydrolek_drake.control.names import TITLES, check_names
from hydrolek_drake.control.thesis_gains import (
    entry,
    pip_gains,
    sample_s,
    scaled_input,
    signal_limit,
    voltage_limit_V,
)
from hydrolek_drake.rigs import Rig
from hydrolek_drake.yaml_files import package_yaml


@dataclass(frozen=True)
class JointSetting:
    """What a controller is built from.

    Attributes:
        model: of the joint; its law gives dead-zone and slopes.
        scaling: of the signal in percent.
        gains_of: joint of the thesis whose gains and weights are used.
        own_model: whether the thesis has no gains for this joint, so that they are designed from the model.
        thesis_form: as the thesis simulated: no anti-windup in PI and PIP with scaled input, no limit but
            10 V behind the inverse dead-zone.
        rates: measured rate map; None to take the model's law for it.
    """

    model: SdpModel
    scaling: ScaledInput
    gains_of: str
    own_model: bool = False
    thesis_form: bool = False
    rates: RateMap | None = None

    @property
    def delay(self) -> int:
        """Delay of the model in control samples."""
        return max(round(self.model.delay_samples * self.model.sample_s / sample_s()), 1)


@cache
def chosen() -> dict[str, Any]:
    """Content of `chosen_gains.yaml`."""
    return package_yaml(__package__, "chosen_gains.yaml")


def thesis_setting(joint: str) -> JointSetting:
    """Setting of chapter 6 for "j1" to "j4" or "j4_linear", in the form that the thesis simulated."""
    plain = joint.removesuffix("_linear")
    return JointSetting(thesis_model(joint), scaled_input(plain), plain, thesis_form=True)


def rig_setting(rig: Rig, joint: str) -> JointSetting:
    """Setting for a joint of a rig: model by simulated step tests, scaling by its calibration.

    Raises:
        InputError: no such joint, not a turning joint, or one that does not move.
    """
    model, rates = rig_model_and_rates(rig, joint)
    record = rig.records()[rig.joints.index(joint)]["command"]
    if rig.variant(joint, "command") == "calibrated":
        full = signal_limit()
        a, b, c, d = (float(record[f"calibration_{key}"]) for key in "abcd")
        if record["polarity"] < 0.0:  # calibrations belong to the chambers
            a, b, c, d = c, d, a, b
        scaling = ScaledInput(-c, a, -d, b, (d - c) / full, (b - a) / full, full)
    else:
        scaling = scaling_from_model(model)
    number = joint.rpartition("_")[2]
    data = chosen()["like"]
    like = data[number]["value"] if number in data else number
    known = like in ("j1", "j2", "j3", "j4")
    return JointSetting(
        model,
        scaling,
        like if known else data["j5"]["value"],
        own_model=not known or number in data,
        rates=rates,
    )


def scaling_from_model(model: SdpModel) -> ScaledInput:
    """Scaling from the dead-zone's edges to 95 % of the saturation rates, for joints without calibration."""
    share = float(chosen()["scaling_share"]["value"])
    slow, fast = model.saturation_deg_per_s
    low, high = model.dead_zone_V
    lowest, highest = model.voltage_at(share * slow), model.voltage_at(share * fast)
    full = signal_limit()
    return ScaledInput(low, high, lowest, highest, (low - lowest) / full, (highest - high) / full, full)


def _inverse(s: JointSetting) -> InverseDeadZone:
    return inverse_dead_zone(s.model, voltage_limit_V(), until_saturation=not s.thesis_form)


def _pi(s: JointSetting) -> ControlLaw:
    k_p, k_i = map(float, entry("pi", s.gains_of))
    return PiLaw(k_p, k_i, sample_s(), s.scaling, anti_windup=not s.thesis_form)


def _pid(s: JointSetting) -> ControlLaw:
    k_p, k_i, k_d, filter_s = (
        float(chosen()["pid"][key]["value"]) for key in ("k_p", "k_i", "k_d", "filter")
    )
    return PidLaw(k_p, k_i, k_d, filter_s, sample_s(), s.scaling)


def _pip(table: str) -> Callable[[JointSetting], ControlLaw]:
    def build(s: JointSetting) -> ControlLaw:
        found = entry(table, s.gains_of)
        gains = pip_gains(table, s.gains_of)
        if s.own_model:
            gains = lq_gains(integrator(s.delay, float(found["b"])), *found["weights"])
        element: Any = _inverse(s)
        if table == "pip_scaled":
            element = s.scaling
        elif table == "pip_no_scaling":
            element = DirectInput(voltage_limit_V())
        return PipLaw(gains, element, anti_windup=not (s.thesis_form and table == "pip_scaled"))

    return build


def _forward(tuning: str) -> Callable[[JointSetting], ControlLaw]:
    def build(s: JointSetting) -> ControlLaw:
        found = entry(f"pip_forward.{tuning}", s.gains_of)
        return ForwardPathLaw(
            tuple(map(float, found["num"])),
            tuple(map(float, found["den"])),
            _inverse(s),
        )

    return build


def _feedforward(s: JointSetting) -> ControlLaw:
    return FeedforwardLaw(s.rates or map_from_model(s.model), sample_s(), voltage_limit_V(), tuning())


def _fuzzy_single(s: JointSetting) -> ControlLaw:
    return SingleInputFuzzyLaw(_inverse(s))


def _fuzzy_double(s: JointSetting) -> ControlLaw:
    return TwoInputFuzzyLaw(_inverse(s))


def _fuzzy_double_printed(s: JointSetting) -> ControlLaw:
    return TwoInputFuzzyLaw(_inverse(s), *printed_surface())


def _fuzzy_appendix_f(s: JointSetting) -> ControlLaw:
    return TwoInputFuzzyLaw(DirectInput(voltage_limit_V()), *appendix_f_surface(s.scaling, s.gains_of))


_BUILDERS: dict[str, Callable[[JointSetting], ControlLaw]] = {
    "pi": _pi,
    "pid": _pid,
    "pip_no_scaling": _pip("pip_no_scaling"),
    "pip_scaled": _pip("pip_scaled"),
    "pip_idz_a": _pip("pip_idz.a"),
    "pip_idz_b": _pip("pip_idz.b"),
    "pip_idz_c": _pip("pip_idz.c"),
    "pip_forward_a": _forward("a"),
    "pip_forward_b": _forward("b"),
    "pip_forward_c": _forward("c"),
    "fuzzy_single": _fuzzy_single,
    "fuzzy_double": _fuzzy_double,
    "fuzzy_double_printed": _fuzzy_double_printed,
    "fuzzy_appendix_f": _fuzzy_appendix_f,
    "feedforward": _feedforward,
}

CONTROLLERS = {name: (title, _BUILDERS[name]) for name, title in TITLES.items()}
"""Name -> how tables call it, and what builds it."""


def build_law(name: str, setting: JointSetting, *, noisy: bool) -> GuardedLaw:
    """A guarded controller by name.

    Args:
        name: of `CONTROLLERS`.
        setting: of the joint.
        noisy: whether its sensor has noise, see `guard.guarded`.

    Raises:
        InputError: no such controller.
    """
    check_names([name])
    model = setting.model
    return guarded(
        CONTROLLERS[name][1](setting),
        (model.lower_deg, model.upper_deg),
        model.dead_zone_V,
        sample_s(),
        noisy=noisy,
    )


def joystick_law(setting: JointSetting, *, noisy: bool) -> GuardedLaw:
    """Guarded joystick rate control of a joint; its set point is the deflection in percent."""
    model = setting.model
    law = RateLaw(
        setting.scaling, float(chosen()["joystick"]["idle"]["value"]), model.lower_deg, model.upper_deg
    )
    return guarded(
        law,
        (model.lower_deg, model.upper_deg),
        model.dead_zone_V,
        sample_s(),
        noisy=noisy,
        clip_set_point=False,
    )
