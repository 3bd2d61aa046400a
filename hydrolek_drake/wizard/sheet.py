"""A data sheet: answers, what is assumed where there is none, and what follows from them."""

import math
from collections.abc import Mapping
from typing import Any

from hydrolek_drake.errors import InputError
from hydrolek_drake.units import si_factor
from hydrolek_drake.wizard.questions import SCREW, SI, Question, Share, fixed, missing, questions

EDGES = ("pa", "pb", "at", "bt")
"""In the order in which a data sheet's four numbers stand."""


class Sheet:
    """Answers, and what follows from them; SI units.

    Attributes:
        answers: key -> answer, as of `read_answers`.
    """

    def __init__(self, answers: Mapping[str, Any]) -> None:
        """Take answers.

        Raises:
            InputError: what no rig can be written without is missing, or contradicts itself.
        """
        self.answers = answers
        left = missing(answers)
        if left:
            told = "; ".join(f"{q.option} ({q.asks}{f' [{q.unit}]' if q.unit else ''})" for q in left)
            raise InputError(f"rig new: not answered: {told}")
        strange = [q.option for q in questions().values() if q.key in answers and not q.applies(answers)]
        if strange:
            keys = ("moves",) if self["moves"] == SCREW else ("moves", "supply", "holding")
            machine = " ".join(f"--{key} {self[key]}" for key in keys)
            raise InputError(f"rig new: {', '.join(strange)}: not of a machine with {machine}")
        if self["moves"] == SCREW:
            self._read_screw()
            return
        bore, rod = self["bore"], self["rod"]
        if not 0.0 <= rod < bore:
            raise InputError(f"rig new: --rod {1e3 * rod:g} mm is not thinner than --bore {1e3 * bore:g} mm")
        self.area_a = 0.25 * math.pi * bore * bore
        self.area_b = self.area_a - 0.25 * math.pi * rod * rod
        self.turns = self["moves"] == "link"
        self.pump = self["supply"] == "pump"
        self.force = self.area_a * self["supply_pressure"]
        self.lever = self._geometry() if self.turns else 1.0
        self.gradients = self._gradients()
        self._check_compensated()
        self.speed = self._speed()

    def _read_screw(self) -> None:
        """Newtons for each ampere, largest force [N], mass with the rotor's [kg], and a speed [m/s]."""
        if self["efficiency"] > 1.0:
            raise InputError(f"rig new: --efficiency {self['efficiency']:g} is more than 1")
        turn = 2.0 * math.pi / self["lead"]
        self.per_amp = turn * self["efficiency"] * self["torque_constant"]
        self.force = self.per_amp * self["peak_current"]
        self.moved = self["mass"] + self["rotor_inertia"] * turn * turn
        crossing = fixed("crossing_time")
        crossing_s = crossing["value"] * si_factor(crossing["unit"], "s")
        self.speed = self["top_speed"] or self["travel"] * min(self["position_gain"], 1.0 / crossing_s)

    def __getitem__(self, key: str) -> Any:
        """An answer, or what is assumed in its place."""
        if key in self.answers:
            given = self.answers[key]
            return given * self[self._question(key).what["percent_of"]] if isinstance(given, Share) else given
        what = self._question(key).what
        if "text" in what:
            return what["text"]
        if "assume" in what:
            return what["assume"] * si_factor_of(self._question(key))
        return what["assume_share"] * self.whole(key)

    def _question(self, key: str) -> Question:
        return questions()[key]

    def whole(self, key: str) -> float:
        """Of what an assumption is a share."""
        if key == "dead_volume":
            return float(self.area_a * self["stroke"])
        if key == "overlap":
            return float(self["spool_travel"])
        if key == "drag_torque":
            return float(self["torque_constant"] * self["peak_current"])
        if key == "pump_leakage":
            return self["displacement"] * self["pump_speed"]
        if key in ("relief_rise", "relief_hysteresis", "accumulator_precharge", "holding_setting"):
            return float(self["supply_pressure"])
        if key == "bearing_damping":
            return self.force * self.lever * self.lever / self.speed
        return self.force / self.speed

    def _geometry(self) -> float:
        """Distances and angles of the triangle; the lever at half of the stroke [m]."""
        (px, py), (cx, cy) = self["base_mount"], self["link_mount"]
        self.parent, self.child = math.hypot(px, py), math.hypot(cx, cy)
        if min(self.parent, self.child) <= 0.0:
            raise InputError("rig new: --base-mount and --link-mount must lie away from the joint axis")
        between = math.atan2(cy, cx) - math.atan2(py, px)
        between = math.remainder(between, 2.0 * math.pi)
        self.direction = 1.0 if between >= 0.0 else -1.0
        self.offset = abs(between)
        included = self.direction * self["mid_stroke_at"] + self.offset
        a, b, half = self.parent, self.child, 0.5 * self["stroke"]
        length = math.sqrt(a * a + b * b - 2.0 * a * b * math.cos(included))
        self.zero_length = length - half
        self.own_stops = "link_travel" in self.answers
        if self.own_stops:
            if not self.zero_length > 0.0:
                raise InputError(
                    f"rig new: at half of the stroke mounts are {length:g} m apart, so that a cylinder of stroke "
                    f"{self['stroke']:g} m has no length drawn in; check --base-mount, --link-mount, --stroke, "
                    "--mid-stroke-at"
                )
            self._told_travel()
            return a * b * math.sin(included) / length
        ends = []
        for end in (length - half, length + half):
            cosine = (a * a + b * b - end * end) / (2.0 * a * b)
            if not 0.0 < included < math.pi or end <= 0.0 or abs(cosine) >= 1.0:
                raise InputError(
                    f"rig new: with mounts {a:g} m and {b:g} m from the axis and {length:g} m between them at half of "
                    f"the stroke, a cylinder cannot reach {end:g} m; check --base-mount, --link-mount, --stroke, "
                    "--mid-stroke-at; if the link's own stops end its motion before, say where (--link-travel)"
                )
            ends.append(self.direction * (math.acos(cosine) - self.offset))
        self.lower, self.upper = min(ends), max(ends)
        return a * b * math.sin(included) / length

    def _told_travel(self) -> None:
        """The link's ends where its own stops are, within what mounts allow."""
        self.lower, self.upper = sorted(self["link_travel"])
        inside = all(0.0 < self.direction * end + self.offset < math.pi for end in (self.lower, self.upper))
        if not inside or not self.lower < self["mid_stroke_at"] < self.upper:
            low, high = sorted(math.degrees(self.direction * (end - self.offset)) for end in (0.0, math.pi))
            raise InputError(
                f"rig new: --link-travel {math.degrees(self.lower):g}, {math.degrees(self.upper):g} deg: must hold "
                f"--mid-stroke-at and lie within {low:.4g} and {high:.4g} deg, where the cylinder has no lever left"
            )

    @property
    def rated_flows(self) -> tuple[float, ...]:
        """Flow at full command through each edge [m^3/s]. # (4,)."""
        flows: tuple[float, ...] = self["rated_flow"]
        return flows * 4 if len(flows) == 1 else flows

    def _check_compensated(self) -> None:
        """A compensated valve is told by its flow, alike towards both sides."""
        if self["compensated"] != "yes":
            return
        if "rated_flow" not in self.answers:
            raise InputError(
                "rig new: --compensated yes: a compensated valve is told by --rated-flow and --rated-drop"
            )
        if self["overlap"] < 0.0:
            raise InputError(
                "rig new: --compensated yes: an underlap (--overlap below zero) is told of four edges alone"
            )
        pa, pb, at, bt = self.rated_flows
        if pa != pb or at != bt or not pa or not at:
            raise InputError(
                "rig new: --compensated yes: --rated-flow must be one number, or alike towards A and B "
                "(P-A as P-B, A-T as B-T)"
            )
        if self["holding"] != "none":
            raise InputError(
                "rig new: --holding is written for a valve with four edges: leave it or --compensated out"
            )

    def _gradients(self) -> dict[str, float]:
        """Area gradient of each edge [m]."""
        if self["overlap"] >= self["spool_travel"]:
            raise InputError(
                f"rig new: --overlap {1e3 * self['overlap']:g} mm: the spool travels {1e3 * self['spool_travel']:g} mm "
                "(--spool-travel), so that no edge would open"
            )
        if "rated_flow" in self.answers:
            flows = self.rated_flows
            speed = self["flow_coefficient"] * math.sqrt(2.0 * self["rated_drop"] / self["oil_density"])
            travel = self["spool_travel"] - self["overlap"]
            return {edge: flow / (speed * travel) for edge, flow in zip(EDGES, flows, strict=True)}
        around = math.pi * self["spool_diameter"]
        return {edge: around * share for edge, share in zip(EDGES, self["port_shares"], strict=True)}

    def _speed(self) -> float:
        """Of the rod with the valve wide open and half of the pressure over its inlet, or all that the pump gives."""
        area = self.gradients["pa"] * (self["spool_travel"] - self["overlap"])
        flow = self["flow_coefficient"] * area * math.sqrt(self["supply_pressure"] / self["oil_density"])
        if self["compensated"] == "yes":
            flow = min(flow, self.rated_flows[0])
        if self.pump:
            given = self["displacement"] * self["pump_speed"]
            if self["pump_leakage"] >= given:
                raise InputError(
                    "rig new: --pump-leakage is no less than what the pump gives (--displacement, --pump-speed)"
                )
            flow = min(flow, given)
        if not flow > 0.0:
            raise InputError("rig new: no oil flows: check openings, overlap, supply pressure and pump")
        return float(flow / self.area_a)


def si_factor_of(question: Question) -> float:
    """Factor from a question's unit to SI."""
    return 2.0 * math.pi if question.unit == "Hz" else si_factor(question.unit, SI[question.unit])
