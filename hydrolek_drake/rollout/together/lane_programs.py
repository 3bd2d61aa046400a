"""What each of some joints does in a step of all of them (`joint`), as loops over lanes called by address.

Which loop a joint takes is told by its kind. With the loops' addresses as numbers, one compiled program drives machines
of whatever joints (`lane_kernel`), and each kind is compiled once for all of them.
"""

from functools import cache
from typing import Any

import numpy as np
from llvmlite import ir
from numba import carray, cfunc, types
from numba.extending import intrinsic

from hydrolek_drake.compiling import COMPILED, njit
from hydrolek_drake.physics.law import LAW, MOST_TERMS
from hydrolek_drake.physics.probes import no_probe
from hydrolek_drake.rollout.lanes.numbers import lane_rows
from hydrolek_drake.rollout.lanes.view import (
    LANES,
    NUMBERS,
    Kind,
    early_of,
    lane_joint,
    lane_law,
    spool_steps_of,
)
from hydrolek_drake.rollout.together.joint import begins, ends, goes_on, halfway
from hydrolek_drake.rollout.together.joint_rows import DRIVE, ROW_SIZE, X

_L = LANES
H, TIME = ROW_SIZE, ROW_SIZE + 1
NUMBERS_OF_JOINT = ROW_SIZE + 2
TERMS = NUMBERS_OF_JOINT + NUMBERS
BLOCK = TERMS + MOST_TERMS * (LAW.itemsize // 8)
"""Rows of a joint in the table, a number of each lane in each: those of `joint_rows`, the step and the time since
switching on [s], the numbers of its record, and those of its law's terms."""


@njit
def _begin(kind: Any, b: np.ndarray) -> None:
    for lane in range(_L):
        joint = lane_joint(kind, b, NUMBERS_OF_JOINT * _L + lane)
        law = lane_law(kind, b, TERMS * _L + lane)
        r = lane_rows(b, BLOCK, lane)
        begins(r, 0, r[0, TIME], r[0, H], spool_steps_of(kind), early_of(kind), no_probe(), law, joint)


@njit
def _go_on(kind: Any, b: np.ndarray) -> None:
    for lane in range(_L):
        joint = lane_joint(kind, b, NUMBERS_OF_JOINT * _L + lane)
        law = lane_law(kind, b, TERMS * _L + lane)
        r = lane_rows(b, BLOCK, lane)
        h = r[0, H]
        halfway(r, 0, h, joint)
        goes_on(r, 0, r[0, DRIVE + X], r[0, TIME] + h, h, no_probe(), law, joint)


@njit
def _end(kind: Any, b: np.ndarray) -> None:
    for lane in range(_L):
        r = lane_rows(b, BLOCK, lane)
        ends(r, 0, r[0, H], lane_joint(kind, b, NUMBERS_OF_JOINT * _L + lane))


@cache
def _compiled(kind: Kind) -> tuple[Any, ...]:
    """The loops of a kind; kept, since only their addresses are handed on."""
    assert (
        kind.name
    )  # what is asked for once is kept with a kind, and what is kept tells compiled functions apart
    options = {"cache": True, **COMPILED}

    @cfunc("int64(CPointer(float64))", **options)
    def beginning(numbers: Any) -> int:
        _begin(kind, carray(numbers, (BLOCK * _L,)))
        return 0

    @cfunc("int64(CPointer(float64))", **options)
    def going_on(numbers: Any) -> int:
        _go_on(kind, carray(numbers, (BLOCK * _L,)))
        return 0

    @cfunc("int64(CPointer(float64))", **options)
    def ending(numbers: Any) -> int:
        _end(kind, carray(numbers, (BLOCK * _L,)))
        return 0

    return beginning, going_on, ending


def programs_of(kind: Kind) -> list[int]:
    """Addresses of what a joint of a kind does at the beginning of a step, in its middle and at its end."""
    return [each.address for each in _compiled(kind)]


@intrinsic
def call_program(typing_context: Any, address: Any, table: Any, place: Any) -> Any:
    """Call a program of `programs_of` with the block of a joint, which begins at a place of the table's numbers."""

    def generate(context: Any, builder: Any, signature: Any, given: Any) -> Any:
        numbers = context.make_array(signature.args[1])(context, builder, given[1]).data
        of = ir.FunctionType(ir.IntType(64), [numbers.type])
        program = builder.inttoptr(given[0], of.as_pointer())
        return builder.call(program, [builder.gep(numbers, [given[2]])])

    return types.int64(types.int64, table, types.intp), generate
