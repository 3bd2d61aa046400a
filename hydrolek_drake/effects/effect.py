"""What an effect is: a named piece of physics that the nominal model leaves out.

Each effect is one file of this folder. It declares its identity and parameters and registers the compiled
functions with which it enters the physics at a hook. A new file is found by itself; nothing else changes.
"""

from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Any

from hydrolek_drake.physics.parameters import Parameter

HOOKS = {
    "command_delay": "(joint) -> s added to the transport delay",
    "coil_gain": "(time, joint) -> factor on both coil currents",
    "land_shift": "(joint) -> m by which the spool's null is shifted towards B",
    "spool_friction": "(velocity, joint) -> N against the spool, and its slope in N s/m",
    "edge_conductance": "(joint) -> m^3/(s Pa) added to each of the four edges",
    "port_drop": "(joint) -> pressure drop in the ports over that across a fully open edge",
    "flow_gain": "(time, joint) -> factor on the flow coefficient",
    "viscous_gain": "(time, joint) -> factor on the cylinder's viscous friction",
    "supply_drop": "(flow, joint) -> Pa by which the supply falls",
    "pump_loss": "(joint) -> share of the pump's flow that is missing",
    "compressibility": "(pressure, joint) -> 1/Pa added to the oil's compressibility",
    "cavity_refilled": "(joint) -> share of a cavity that oil has to fill again",
    "cross_conductance": "(joint) -> m^3/(s Pa) from chamber A to B",
    "rod_friction": "(friction.Sliding, joint) -> N against the rod, and its slope in N s/m",
    "rod_damping": "(velocity, stroke, joint) -> N against the rod, and its slope in N s/m",
    "load_friction": "(velocity, joint) -> N or N m against the load, and its slope",
    "payload": "(time, joint) -> kg carried at the tool",
    "reading_error": "(angle, time, joint) -> rad or m added to the reading",
    "reading_play": "(joint) -> rad or m of half width of play in the reading",
    "linkage_gap": "(joint) -> rad of play in all between cylinder side and link",
    "base_stiffness": "(joint) -> N m/rad of the base's spring, 0 for a rigid base",
    "base_inertia": "(joint) -> kg m^2 of the base",
}


STICKS_AND_SLIPS = 0.5
"""`Effect.step_share` of a friction with which a joint sticks and slips: it breaks away within a millisecond. Where the
machine's own numbers are known the rollout leaves 1.4 and 10 times the noise at 1 ms, 0.94 and 3.8 times at 0.5 ms
(right_j2 and right_j5, 40 s)."""


@dataclass(frozen=True)
class Search:
    """How far a fit looks for one parameter of an effect, in multiples of a natural scale of the machine.

    Attributes:
        of: attribute of `scales.Scales`.
        largest: upper end of the range.
        starts: where a search begins, all of them tried; a second sign is a start of its own.
        lowest: lower end of the range.
        log: whether the range is searched on a logarithmic scale.
        moment: whether it is when something happens, which is not found by going downhill.
        beyond: attribute of `scales.Scales` from which the upper end and the starts are counted: what is nearer never
            acted in the recording. Nothing if not given.
    """

    of: str
    largest: float
    starts: tuple[float, ...]
    lowest: float = 0.0
    log: bool = False
    moment: bool = False
    beyond: str = ""


@dataclass(frozen=True)
class Formula:
    """The equation of an effect as it is typeset.

    Attributes:
        latex: in LaTeX's mathematics.
        symbols: parameter -> its letter in `latex`.
        letters: every other letter -> what it means.
    """

    latex: str
    symbols: dict[str, str]
    letters: dict[str, str] = field(default_factory=dict)


@dataclass(frozen=True)
class Effect:
    """One effect: identity, equation, parameters and the hooks by which it enters the physics.

    Attributes:
        id: `stage.name` as in reports and rig files.
        title: what it is, in a few words.
        equation: how it enters the model.
        parameters: all with a neutral value.
        size: the parameter that switches it on (its neutral value means: not there).
        source: where the law comes from.
        confused_with: ids of effects with a similar signature, and what tells them apart.
        needs: the variants it can act on, as `section: names`; empty for all.
        search: parameter -> how far a fit looks for it.
        reads: numbers of a joint, as `section.name`, that no part of the machine reads but effects like this one: they
            are searched with it where the rig gives them a range, as speeds over which a dry friction is smoothed.
        searched_on: the variants on which a diagnosis looks for it, as `needs`; fewer than those it can act
            on where another effect says the same of a hydraulic joint.
        weakens: whether it fades as its size grows, like a spring that becomes stiffer.
        sudden: whether the joint moves otherwise as soon as it is there, however small it is, as when a contact opens;
            then a fitted model without it does not tell what it would gain.
        step_share: steps so many times a rig's own resolve it: contacts that open and close need shorter ones than what
            moves smoothly.
        contains: ids of effects that are special cases of it, so that both together say nothing new.
        beneath: attribute of `scales.Scales`: no larger than this, its size says no more than what the equations
            themselves simplify. Nothing if not given.
        formula: the equation as reports draw it; None where it is told in words only.
        inspect: one sentence: what to look at or measure on the machine where this effect is named.
    """

    id: str
    title: str
    equation: str
    parameters: tuple[Parameter, ...]
    size: str
    source: str
    confused_with: dict[str, str] = field(default_factory=dict)
    needs: dict[str, tuple[str, ...]] = field(default_factory=dict)
    search: dict[str, Search] = field(default_factory=dict)
    reads: tuple[str, ...] = ()
    searched_on: dict[str, tuple[str, ...]] = field(default_factory=dict)
    weakens: bool = False
    sudden: bool = False
    step_share: float = 1.0
    contains: tuple[str, ...] = ()
    beneath: str = ""
    formula: Formula | None = None
    inspect: str = ""
    hooks: dict[str, Callable[..., Any]] = field(default_factory=dict)

    @property
    def stage(self) -> str:
        """The stage of the chain at which it acts."""
        return self.id.split(".")[0]

    @property
    def neutral_size(self) -> float:
        """The size at which it is not there."""
        neutral = next(p.neutral for p in self.parameters if p.name == self.size)
        assert neutral is not None  # every parameter of an effect has one
        return neutral

    @property
    def key(self) -> str:
        """Its field in the joint's record."""
        return self.id.replace(".", "_")

    def hook(self, name: str) -> Callable[[Callable[..., Any]], Callable[..., Any]]:
        """Decorator: register a compiled function at a hook of `HOOKS`."""
        if name not in HOOKS:
            raise ValueError(f"effect {self.id}: no hook '{name}'; there are {', '.join(HOOKS)}")

        def register(function: Callable[..., Any]) -> Callable[..., Any]:
            self.hooks[name] = function
            return function

        return register
