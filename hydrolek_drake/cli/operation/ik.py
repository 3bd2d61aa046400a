"""`hydrolek ik`: joint angles for a target, or what keeps the arm from it."""

import json
from typing import TYPE_CHECKING, Annotated

import typer

from hydrolek_drake.cli.settings import SeedOption
from hydrolek_drake.errors import InputError

if TYPE_CHECKING:
    from rich.table import Table

    from hydrolek_drake.kinematics.forward import Array

_METHODS = ("closed-form", "jacobian-transpose")
_Vector = tuple[float, float, float]


def ik(
    side: Annotated[str, typer.Argument(metavar="ARM", help="right or left")],
    position: Annotated[_Vector, typer.Option(metavar="X Y Z", help="target, in the unit of --unit")],
    direction: Annotated[
        _Vector | None, typer.Option(metavar="X Y Z", help="where the tool shall point; free if not given")
    ] = None,
    jaw_axis: Annotated[
        _Vector | None,
        typer.Option(metavar="X Y Z", help="a pipe's axis, to turn the jaws' axis parallel to by joint 6"),
    ] = None,
    unit: Annotated[str, typer.Option(help="of --position: m, mm, in, ...")] = "m",
    frame: Annotated[
        str | None,
        typer.Option(
            help="right_base or left_base (X forward, Y up, Z right), plate or world (x forward, y left, "
            "z up); the arm's own base if not given"
        ),
    ] = None,
    point: Annotated[str, typer.Option(help="tool, the grasp point, or wrist, P in (5.3)")] = "tool",
    near: Annotated[
        tuple[float, float, float, float, float, float] | None,
        typer.Option(metavar="DEG ...", help="wanted joints 1 to 6 in degrees; mid-travel if not given"),
    ] = None,
    method: Annotated[str, typer.Option(help=" or ".join(_METHODS))] = _METHODS[0],
    tolerance_mm: Annotated[float, typer.Option(help="of the Jacobian transpose")] = 1.0,
    most_iterations: Annotated[int, typer.Option(min=1, help="of the Jacobian transpose")] = 10_000,
    as_json: Annotated[bool, typer.Option("--json", help="print JSON instead of a table")] = False,
    seed: SeedOption = None,
) -> None:
    """Find the joint angles that put one arm's tool at a target; exit status 2 says what makes that impossible."""
    import numpy as np

    from hydrolek_drake.cli.output import console
    from hydrolek_drake.kinematics.chain import SIDES
    from hydrolek_drake.kinematics.frames import direction_in_frame, in_frame
    from hydrolek_drake.kinematics.inverse import inverse_pose, inverse_position
    from hydrolek_drake.units import si_factor

    if side not in SIDES:
        raise InputError(f"ik: arm '{side}' is unknown; choose from {', '.join(SIDES)}")
    if method not in _METHODS:
        raise InputError(f"ik: --method '{method}' is unknown; choose from {', '.join(_METHODS)}")
    base = f"{side}_base"
    given_in = frame or base
    target = in_frame(np.array(position) * si_factor(unit, "m"), given_in=given_in, wanted_in=base)
    wanted = None if near is None else np.radians(near)

    if method == "jacobian-transpose":
        if direction is not None or jaw_axis is not None:
            raise InputError("ik: the Jacobian transpose solves the position alone; leave --direction out")
        angles = _transpose(target, side, point, wanted, tolerance_mm * 1e-3, most_iterations)
    elif direction is None:
        if jaw_axis is not None:
            raise InputError("ik: --jaw-axis needs --direction, about which joint 6 turns the jaws")
        angles = inverse_position(target, side, point=point, near=wanted).nearest()[None]
    else:
        axis = None if jaw_axis is None else direction_in_frame(jaw_axis, given_in=given_in, wanted_in=base)
        result = inverse_pose(
            target,
            direction_in_frame(direction, given_in=given_in, wanted_in=base),
            side,
            point=point,
            jaw_axis=axis,
            near=wanted,
        )
        result.nearest()  # raises the reason
        angles = result.angles
    if as_json:
        print(json.dumps({"arm": side, "angles_deg": np.degrees(angles).tolist()}))
    else:
        console().print(_table(side, angles))


def _transpose(
    target: "Array", side: str, point: str, start: "Array | None", tolerance: float, most_iterations: int
) -> "Array":
    from hydrolek_drake.kinematics.chain import arm_chain
    from hydrolek_drake.kinematics.jacobian_transpose import jacobian_transpose

    result = jacobian_transpose(
        target,
        arm_chain(side).middle if start is None else start,
        side=side,
        point=point,
        tolerance=tolerance,
        most_iterations=most_iterations,
    )
    if not result.converged:
        raise InputError(
            f"ik: the Jacobian transpose is stuck {1e3 * result.error:.3g} mm from the target after "
            f"{result.iterations} iterations; use --method closed-form, which says why"
        )
    return result.angles[None]


def _table(side: str, angles: "Array") -> "Table":
    import numpy as np
    from rich.table import Table

    from hydrolek_drake.kinematics.chain import joint_limits
    from hydrolek_drake.kinematics.cylinder_linkage import cylinder_linkages

    lower, upper = (np.degrees(limits) for limits in joint_limits(side))
    cylinders = cylinder_linkages()
    headings = [f"posture {n + 1} / deg" for n in range(len(angles))]
    table = Table("joint", *headings, "travel / deg", "cylinder / mm")
    for joint in range(6):
        name = f"{side}_j{joint + 1}"
        endless = not np.isfinite(lower[joint])
        cylinder = ""
        if name in cylinders:
            cylinder = ", ".join(f"{1e3 * cylinders[name].length(row[joint]):.1f}" for row in angles)
        table.add_row(
            name,
            *(f"{np.degrees(row[joint]):.4f}" for row in angles),
            "endless" if endless else f"{lower[joint]:.2f} to {upper[joint]:.2f}",
            cylinder,
        )
    return table
