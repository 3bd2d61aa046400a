"""A number of every lane at once, as an element of arrays in compiled code.

Functions of plain numbers whose way does not depend on those (sums, products, quotients, roots over loops of known
length, as in `physics.bodies.serial_arm`) are compiled for it as they are, and are vector instructions then; each lane
is what it would be alone, to the last bit, since these operations round alike.
"""

import math
import operator
from typing import Any

from llvmlite import ir
from numba import types
from numba.core import cgutils
from numba.core.typeconv import Conversion
from numba.core.typing.templates import AbstractTemplate, infer_global, signature
from numba.extending import intrinsic, lower_builtin, lower_cast, models, register_model

from hydrolek_drake.rollout.lanes.view import LANES

_DOUBLE = ir.DoubleType()
_NUMBERS = ir.VectorType(_DOUBLE, LANES)


class LaneNumber(types.Type):
    """Numba's type of one number of each lane."""

    def __init__(self) -> None:
        super().__init__(name=f"LaneNumber({LANES})")

    def can_convert_from(self, _context: Any, other: Any) -> Conversion | None:
        """A plain number is that of every lane."""
        return Conversion.promote if isinstance(other, types.Float | types.Integer) else None


lane_number = LaneNumber()


class LaneArray(types.Type):
    """Numba's type of an array whose elements are a number of each lane; its last axis in memory are the lanes."""

    def __init__(self, ndim: int) -> None:
        self.ndim = ndim
        super().__init__(name=f"LaneArray({LANES}, {ndim})")


class LaneRows(types.Type):
    """Numba's type of one lane's numbers in such an array of two dimensions: its elements are plain numbers."""

    def __init__(self) -> None:
        super().__init__(name=f"LaneRows({LANES})")


lane_rows_type = LaneRows()


@register_model(LaneNumber)
class _NumberModel(models.PrimitiveModel):
    def __init__(self, manager: Any, of: Any) -> None:
        super().__init__(manager, of, _NUMBERS)


@register_model(LaneArray)
class _ArrayModel(models.StructModel):
    def __init__(self, manager: Any, of: Any) -> None:
        shape = [(f"size{axis}", types.intp) for axis in range(of.ndim)]
        super().__init__(manager, of, [("data", types.CPointer(types.float64)), *shape])


@register_model(LaneRows)
class _RowsModel(models.StructModel):
    def __init__(self, manager: Any, of: Any) -> None:
        super().__init__(manager, of, [("data", types.CPointer(types.float64)), ("size1", types.intp)])


@lower_cast(types.Float, LaneNumber)
@lower_cast(types.Integer, LaneNumber)
def _spread(context: Any, builder: Any, of: Any, to: Any, value: Any) -> Any:
    value = context.cast(builder, value, of, types.float64)
    index = ir.Constant(ir.IntType(32), 0)
    one = builder.insert_element(ir.Constant(_NUMBERS, ir.Undefined), value, index)
    nowhere = ir.Constant(_NUMBERS, ir.Undefined)
    places = ir.Constant(ir.VectorType(ir.IntType(32), LANES), [0] * LANES)
    return builder.shuffle_vector(one, nowhere, places)


def _operation(of: Any, in_place: Any, instruction: str) -> None:
    """Sums and so on of numbers of all lanes, or of such and a plain number."""

    class Typed(AbstractTemplate):
        def generic(self, given: Any, _named: Any) -> Any:
            numbers = all(isinstance(a, LaneNumber | types.Float | types.Integer) for a in given)
            if len(given) == 2 and numbers and any(isinstance(a, LaneNumber) for a in given):
                return signature(lane_number, lane_number, lane_number)
            return None

    for each in (of, in_place):
        infer_global(each)(type("Typed", (Typed,), {"key": each}))

        @lower_builtin(each, LaneNumber, LaneNumber)
        def _lowered(_context: Any, builder: Any, _signature: Any, given: Any) -> Any:
            return getattr(builder, instruction)(*given)


_operation(operator.add, operator.iadd, "fadd")
_operation(operator.sub, operator.isub, "fsub")
_operation(operator.mul, operator.imul, "fmul")
_operation(operator.truediv, operator.itruediv, "fdiv")


@infer_global(operator.neg)
@infer_global(math.sqrt)
class _OfOne(AbstractTemplate):
    def generic(self, given: Any, _named: Any) -> Any:
        known = len(given) == 1 and isinstance(given[0], LaneNumber)
        return signature(lane_number, lane_number) if known else None


@lower_builtin(operator.neg, LaneNumber)
def _negated(_context: Any, builder: Any, _signature: Any, given: Any) -> Any:
    return builder.fneg(given[0])


@lower_builtin(math.sqrt, LaneNumber)
def _root(_context: Any, builder: Any, _signature: Any, given: Any) -> Any:
    of = ir.FunctionType(_NUMBERS, [_NUMBERS])
    name = f"llvm.sqrt.v{LANES}f64"
    return builder.call(cgutils.get_or_insert_function(builder.module, of, name), given)


def _places(context: Any, builder: Any, index_type: Any, index: Any) -> list[Any]:
    """Places along the axes that an index names."""
    if not isinstance(index_type, types.BaseTuple):
        return [context.cast(builder, index, index_type, types.intp)]
    parts = cgutils.unpack_tuple(builder, index, len(index_type))
    return [
        context.cast(builder, part, of, types.intp) for part, of in zip(parts, index_type.types, strict=True)
    ]


def _indexes(index: Any) -> int:
    """How many axes an index names; 0 if it is none."""
    if isinstance(index, types.Integer):
        return 1
    if isinstance(index, types.BaseTuple) and all(isinstance(each, types.Integer) for each in index.types):
        return len(index.types)
    return 0


def _at(context: Any, builder: Any, array: LaneArray, value: Any, places: list[Any]) -> Any:
    """Pointer to the numbers of an element or of the first one of a part."""
    made = cgutils.create_struct_proxy(array)(context, builder, value=value)
    flat = places[0]
    for axis in range(1, array.ndim):
        flat = builder.mul(flat, getattr(made, f"size{axis}"))
        if axis < len(places):
            flat = builder.add(flat, places[axis])
    return builder.gep(made.data, [builder.mul(flat, context.get_constant(types.intp, LANES))], inbounds=True)


@infer_global(operator.getitem)
class _Got(AbstractTemplate):
    def generic(self, given: Any, _named: Any) -> Any:
        array, index = given
        axes = _indexes(index)
        if isinstance(array, LaneArray) and 0 < axes <= array.ndim:
            part = lane_number if axes == array.ndim else LaneArray(array.ndim - axes)
            return signature(part, array, index)
        if isinstance(array, LaneRows) and axes == 2:
            return signature(types.float64, array, index)
        return None


@infer_global(operator.setitem)
class _Set(AbstractTemplate):
    def generic(self, given: Any, _named: Any) -> Any:
        array, index, value = given
        axes = _indexes(index)
        number = isinstance(value, types.Float | types.Integer)
        if isinstance(array, LaneArray) and axes == array.ndim and (number or isinstance(value, LaneNumber)):
            return signature(types.none, array, index, lane_number)
        if isinstance(array, LaneRows) and axes == 2 and number:
            return signature(types.none, array, index, types.float64)
        return None


@lower_builtin(operator.getitem, LaneArray, types.Integer)
@lower_builtin(operator.getitem, LaneArray, types.BaseTuple)
def _get(context: Any, builder: Any, of: Any, given: Any) -> Any:
    array, index = of.args
    places = _places(context, builder, index, given[1])
    at = _at(context, builder, array, given[0], places)
    if of.return_type == lane_number:
        numbers = builder.load(builder.bitcast(at, _NUMBERS.as_pointer()))
        numbers.align = 8  # bytes: wherever the array begins
        return numbers
    whole = cgutils.create_struct_proxy(array)(context, builder, value=given[0])
    part = cgutils.create_struct_proxy(of.return_type)(context, builder)
    part.data = at
    for axis in range(of.return_type.ndim):
        setattr(part, f"size{axis}", getattr(whole, f"size{axis + len(places)}"))
    return part._getvalue()


@lower_builtin(operator.setitem, LaneArray, types.Integer, LaneNumber)
@lower_builtin(operator.setitem, LaneArray, types.BaseTuple, LaneNumber)
def _put(context: Any, builder: Any, of: Any, given: Any) -> Any:
    array, index, _ = of.args
    at = _at(context, builder, array, given[0], _places(context, builder, index, given[1]))
    builder.store(given[2], builder.bitcast(at, _NUMBERS.as_pointer())).align = 8
    return context.get_dummy_value()


def _element(context: Any, builder: Any, value: Any, index_type: Any, index: Any) -> Any:
    rows = cgutils.create_struct_proxy(lane_rows_type)(context, builder, value=value)
    row, column = _places(context, builder, index_type, index)
    flat = builder.add(builder.mul(row, rows.size1), column)
    return builder.gep(rows.data, [builder.mul(flat, context.get_constant(types.intp, LANES))], inbounds=True)


@lower_builtin(operator.getitem, LaneRows, types.BaseTuple)
def _get_one(context: Any, builder: Any, of: Any, given: Any) -> Any:
    return builder.load(_element(context, builder, given[0], of.args[1], given[1]))


@lower_builtin(operator.setitem, LaneRows, types.BaseTuple, types.Float)
def _put_one(context: Any, builder: Any, of: Any, given: Any) -> Any:
    builder.store(given[2], _element(context, builder, given[0], of.args[1], given[1]))
    return context.get_dummy_value()


@infer_global(len)
class _Length(AbstractTemplate):
    def generic(self, given: Any, _named: Any) -> Any:
        known = len(given) == 1 and isinstance(given[0], LaneArray)
        return signature(types.intp, given[0]) if known else None


@lower_builtin(len, LaneArray)
def _length(context: Any, builder: Any, of: Any, given: Any) -> Any:
    return cgutils.create_struct_proxy(of.args[0])(context, builder, value=given[0]).size0


@intrinsic
def lane_array(typing_context: Any, array: Any) -> Any:
    """What stands in an array whose last axis are the lanes, as an array of a number of each lane."""
    result = LaneArray(array.ndim - 1)

    def generate(context: Any, builder: Any, of: Any, given: Any) -> Any:
        source = context.make_array(of.args[0])(context, builder, given[0])
        made = cgutils.create_struct_proxy(result)(context, builder)
        made.data = source.data
        for axis, size in enumerate(cgutils.unpack_tuple(builder, source.shape)[:-1]):
            setattr(made, f"size{axis}", size)
        return made._getvalue()

    return result(array), generate


@intrinsic
def lane_rows(typing_context: Any, array: Any, size: Any, place: Any) -> Any:
    """One lane's numbers: of an array of so many numbers of each lane a row, those from a place on, `LANES` apart."""

    def generate(context: Any, builder: Any, of: Any, given: Any) -> Any:
        source = context.make_array(of.args[0])(context, builder, given[0])
        made = cgutils.create_struct_proxy(lane_rows_type)(context, builder)
        made.data = builder.gep(source.data, [given[2]], inbounds=True)
        made.size1 = given[1]
        return made._getvalue()

    return lane_rows_type(array, types.intp, types.intp), generate
