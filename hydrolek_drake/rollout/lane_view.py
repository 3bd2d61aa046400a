"""A joint's record as one of several machines in lanes sees it: the physics' functions take it in the record's place.

The numbers of `LANES` machines stand side by side, parameter after parameter, so that a loop over the lanes is done by
vector instructions: the same scalar functions are compiled for this view of their `joint` argument, and no equation
stands twice. What is known when a loop is compiled (variants, effects that are off in every lane) is a constant in it,
of which the compiler leaves out the branches.
"""

import hashlib
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np
from numba import types
from numba.core import cgutils
from numba.core.imputils import lower_getattr_generic
from numba.core.typing.templates import AttributeTemplate, infer_getattr
from numba.extending import NativeValue, intrinsic, models, register_model, typeof_impl, unbox

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
    """

    known: tuple[tuple[int, float], ...]
    spool_steps: int

    @cached_property
    def name(self) -> str:
        """Short, and another one for every kind."""
        return hashlib.sha256(repr((self.known, self.spool_steps)).encode()).hexdigest()[:12]


class KindType(types.Opaque):
    """Numba's type of a `Kind`: kinds are told apart when a function is compiled."""

    def __init__(self, name: str, known: tuple[tuple[int, float], ...], spool_steps: int) -> None:
        self.known, self.spool_steps = known, spool_steps
        super().__init__(name=f"Kind({name})")


register_model(KindType)(models.OpaqueModel)


@unbox(KindType)
def _unbox_kind(typ: Any, value: Any, c: Any) -> NativeValue:
    """Nothing of a kind is needed at run time: all of it is in its type."""
    return NativeValue(c.context.get_dummy_value())


@typeof_impl.register(Kind)
def _kind_type(kind: Kind, _context: Any) -> KindType:
    return KindType(kind.name, kind.known, kind.spool_steps)


class LaneView(types.Type):
    """Numba's type of a record, or a part of it, in a lane."""

    def __init__(self, kind: KindType, path: tuple[str, ...]) -> None:
        self.kind, self.path = kind, path
        super().__init__(name=f"LaneView({kind.name},{'.'.join(path)})")

    def field(self, name: str) -> tuple[np.dtype, int]:
        """Type and place, in numbers, of a field."""
        dtype, place = JOINT, 0
        for part in (*self.path, name):
            dtype, offset = dtype.fields[part][:2]  # type: ignore[index]
            place += offset // 8
        return dtype, place

    def has(self, name: str) -> bool:
        """Whether there is such a field."""
        dtype = JOINT
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
        return LaneView(view.kind, (*view.path, name)) if dtype.names else types.float64


@lower_getattr_generic(LaneView)
def _read(context: Any, builder: Any, view: LaneView, value: Any, name: str) -> Any:
    dtype, place = view.field(name)
    if dtype.names:
        return value
    known = dict(view.kind.known)
    if place in known:
        return context.get_constant(types.float64, known[place])
    lane = cgutils.create_struct_proxy(view)(context, builder, value=value)
    at = builder.add(lane.place, context.get_constant(types.intp, place * LANES))
    return builder.load(builder.gep(lane.numbers, [at], inbounds=True))


@intrinsic
def lane_joint(typing_context: Any, kind: Any, table: Any, place: Any) -> Any:
    """The record of one lane: `table` holds its numbers from `place` on, `LANES` apart."""
    view = LaneView(kind, ())

    def generate(context: Any, builder: Any, signature: Any, arguments: Any) -> Any:
        array = context.make_array(signature.args[1])(context, builder, arguments[1])
        lane = cgutils.create_struct_proxy(view)(context, builder)
        lane.numbers, lane.place = array.data, arguments[2]
        return lane._getvalue()

    return view(kind, table, types.intp), generate


@intrinsic
def spool_steps_of(typing_context: Any, kind: Any) -> Any:
    """Steps of the spool within one step, as a constant: its loop is unrolled."""

    def generate(context: Any, builder: Any, signature: Any, arguments: Any) -> Any:
        return context.get_constant(types.intp, signature.args[0].spool_steps)

    return types.intp(kind), generate
