"""A joint's record as one of several machines in lanes sees it: the physics' functions take it in the record's place.

The numbers of `LANES` machines stand side by side, parameter after parameter, so that a loop over the lanes is done by
vector instructions: the same scalar functions are compiled for this view of their `joint` argument, and no equation
stands twice. What is known when a loop is compiled (variants, effects that are off in every lane) is a constant in it,
of which the compiler leaves out the branches.
"""

import hashlib
from collections.abc import Callable
from dataclasses import dataclass, fields
from functools import cached_property
from typing import Any

import numpy as np
from numba import types
from numba.core import cgutils
from numba.core.imputils import lower_constant, lower_getattr_generic
from numba.core.typing.templates import AttributeTemplate, infer_getattr
from numba.extending import NativeValue, intrinsic, models, register_model, typeof_impl, unbox

from hydrolek_drake.physics.law import LAW
from hydrolek_drake.physics.records import JOINT

LANES = 8
"""Machines that are rolled out in lockstep: as many numbers as the widest vector registers of today hold, two or four
registers of others. Results do not depend on it."""

NUMBERS = JOINT.itemsize // 8
"""Of a record."""


@dataclass(frozen=True)
class Kind:
    """What is alike in all lanes, and known when the loop over them is compiled.

    Attributes:
        known: places in a flat record, and the numbers that stand there in every lane.
        spool_steps: steps of the spool within one step.
        terms: of the law of every lane; 0 for none. Which factors they have may differ.
        early: whether the laws may act before the spool or on it.
        probed: whether there are inputs from outside, `probes.PROBES`.
        together: whether it is a joint of those that move together.
    """

    known: tuple[tuple[int, float], ...]
    spool_steps: int
    terms: int = 0
    early: bool = False
    probed: bool = False
    together: bool = False

    @cached_property
    def name(self) -> str:
        """Short, and another one for every kind."""
        own = tuple(getattr(self, each.name) for each in fields(self))
        return hashlib.sha256(repr(own).encode()).hexdigest()[:12]


class KindType(types.Opaque):
    """Numba's type of a `Kind`: kinds are told apart when a function is compiled."""

    def __init__(self, kind: Kind) -> None:
        self.kind = kind
        super().__init__(name=f"Kind({kind.name})")


register_model(KindType)(models.OpaqueModel)


@lower_constant(KindType)
def _constant_kind(context: Any, builder: Any, typ: Any, kind: Any) -> Any:
    return context.get_dummy_value()


@unbox(KindType)
def _unbox_kind(typ: Any, value: Any, c: Any) -> NativeValue:
    """Nothing of a kind is needed at run time: all of it is in its type."""
    return NativeValue(c.context.get_dummy_value())


@typeof_impl.register(Kind)
def _kind_type(kind: Kind, _context: Any) -> KindType:
    return KindType(kind)


class LaneView(types.Type):
    """Numba's type of a joint's record, a part of it, or a term of its law, in a lane."""

    def __init__(self, kind: KindType, path: tuple[str, ...], record: np.dtype = JOINT) -> None:
        self.kind, self.path, self.record = kind, path, record
        self.known = dict(kind.kind.known) if record is JOINT else {}
        of = "joint" if record is JOINT else "law"
        super().__init__(name=f"LaneView({kind.name},{of},{'.'.join(path)})")

    def field(self, name: str) -> tuple[np.dtype, int]:
        """Type and place, in numbers, of a field."""
        dtype, place = self.record, 0
        for part in (*self.path, name):
            dtype, offset = dtype.fields[part][:2]  # type: ignore[index]
            place += offset // 8
        return dtype, place

    def part(self, name: str) -> "LaneView":
        """The view of a stage or an effect."""
        return LaneView(self.kind, (*self.path, name), self.record)

    def has(self, name: str) -> bool:
        """Whether there is such a field."""
        dtype = self.record
        for part in self.path:
            dtype = dtype.fields[part][0]  # type: ignore[index]
        return name in (dtype.names or ())


@register_model(LaneView)
class _LaneModel(models.StructModel):
    def __init__(self, manager: Any, kind: Any) -> None:
        super().__init__(manager, kind, [("numbers", types.CPointer(types.float64)), ("place", types.intp)])


@infer_getattr
class _Fields(AttributeTemplate):
    key = LaneView

    def generic_resolve(self, view: LaneView, name: str) -> Any:
        if not view.has(name):
            return None
        dtype, _ = view.field(name)
        return view.part(name) if dtype.names else types.float64


@lower_getattr_generic(LaneView)
def _read(context: Any, builder: Any, view: LaneView, value: Any, name: str) -> Any:
    dtype, place = view.field(name)
    if dtype.names:
        return value
    if place in view.known:
        return context.get_constant(types.float64, view.known[place])
    lane = cgutils.create_struct_proxy(view)(context, builder, value=value)
    at = builder.add(lane.place, context.get_constant(types.intp, place * LANES))
    return builder.load(builder.gep(lane.numbers, [at], inbounds=True))


def _view_at(context: Any, builder: Any, view: LaneView, table: Any, array: Any, place: Any) -> Any:
    lane = cgutils.create_struct_proxy(view)(context, builder)
    lane.numbers, lane.place = context.make_array(table)(context, builder, array).data, place
    return lane._getvalue()


@intrinsic
def lane_joint(typing_context: Any, kind: Any, table: Any, place: Any) -> Any:
    """The record of one lane: `table` holds its numbers from `place` on, `LANES` apart."""
    view = LaneView(kind, ())

    def generate(context: Any, builder: Any, signature: Any, arguments: Any) -> Any:
        _, array, at = arguments
        return _view_at(context, builder, view, signature.args[1], array, at)

    return view(kind, table, types.intp), generate


@intrinsic
def lane_law(typing_context: Any, kind: Any, table: Any, place: Any) -> Any:
    """The terms of one lane's law, whose numbers `table` holds from `place` on, `LANES` apart; None without a law."""
    terms = kind.kind.terms
    result = types.UniTuple(LaneView(kind, (), LAW), terms) if terms else types.none

    def generate(context: Any, builder: Any, signature: Any, arguments: Any) -> Any:
        if not terms:
            return context.get_dummy_value()
        _, array, first = arguments
        size = LAW.itemsize // 8 * LANES
        places = [builder.add(first, context.get_constant(types.intp, size * term)) for term in range(terms)]
        views = [
            _view_at(context, builder, result.dtype, signature.args[1], array, place) for place in places
        ]
        return context.make_tuple(builder, result, views)

    return result(kind, table, types.intp), generate


def _constant(what: Callable[[Kind], Any], of: Any) -> Any:
    """What of a kind is a constant of the compiled loop, so that loops are unrolled and branches left out."""

    @intrinsic
    def constant(typing_context: Any, kind: Any) -> Any:
        def generate(context: Any, builder: Any, signature: Any, arguments: Any) -> Any:
            return context.get_constant(of, what(signature.args[0].kind))

        return of(kind), generate

    return constant


spool_steps_of = _constant(lambda kind: kind.spool_steps, types.intp)
"""Steps of the spool within one step."""

early_of = _constant(lambda kind: kind.early, types.boolean)
"""Whether laws may act before the spool or on it."""

probed_of = _constant(lambda kind: kind.probed, types.boolean)
"""Whether there are inputs from outside."""
