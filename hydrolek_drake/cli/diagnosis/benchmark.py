"""`hydrolek benchmark`: the performance table."""

import json
from pathlib import Path
from typing import Annotated

import typer


def benchmark(
    out: Annotated[Path | None, typer.Option(metavar="DIR", help="folder for benchmark.json")] = None,
    repeats: Annotated[int, typer.Option(min=1, help="runs of each execution; the median counts")] = 3,
    seed: Annotated[int, typer.Option(help="of the random voltages")] = 1,
    pairs: Annotated[
        Path | None,
        typer.Option(metavar="DIR", help="also fits and diagnoses of its practice_NN; takes minutes"),
    ] = None,
) -> None:
    """Measure how fast the executions are against real time and each other, and how exact the rollout is."""
    from rich.table import Table

    from hydrolek_drake.benchmark.measure import measure
    from hydrolek_drake.cli.output import console, progress
    from hydrolek_drake.files import write_results

    output = console()
    with progress("measuring") as tell:
        figures = measure(seed, repeats, lambda what: tell(f"measuring: {what}"), pairs)
    table = Table("execution", "times real time", "lowest to highest", "runs", "rollout is faster by")
    for speed in figures["speeds"]:
        ratio = figures["ratios"].get(f"rollout over {speed['name']}")
        table.add_row(
            speed["name"],
            f"{speed['times_real_time']:.4g}",
            f"{speed['lowest']:.4g} to {speed['highest']:.4g}",
            str(speed["runs"]),
            "" if ratio is None else f"{ratio:.4g}",
        )
    output.print(table)
    lanes = Table(
        "machines in lanes", "how many", "rollouts of one", "one by one", "machine-seconds per second"
    )
    for row in figures["lanes"]:
        lanes.add_row(
            row["machine"],
            str(row["count"]),
            f"{row['in_lanes']:.2f}",
            f"{row['one_by_one']:.2f}",
            f"{row['machine_seconds']:.4g}",
        )
    for row in figures["jacobians"]:
        lanes.add_row(
            f"Jacobian: {row['machine']}",
            str(row["count"]),
            f"{row['in_lanes']:.2f}",
            f"{row['one_by_one']:.2f}",
            f"{row['machine_seconds']:.4g}",
        )
    output.print(lanes)
    if figures["commands"]:
        whole = Table(
            "command", "processor [s]", "clock [s]", "one by one: processor [s]", "clock [s]", "ratio"
        )
        for row in figures["commands"]:
            seconds = [row[name] for name in ("in_lanes", "in_lanes_clock", "one_by_one", "one_by_one_clock")]
            ratio = row["in_lanes"] / row["one_by_one"]
            whole.add_row(row["name"], *(f"{each:.1f}" for each in seconds), f"{ratio:.2f}")
        output.print(whole)
    error = figures["rollout_error_deg"]
    output.print(
        f"rollout against its 0.01 ms reference: {error['rms']:.4f} deg rms, {error['largest']:.4f} deg at most; "
        f"LSODA against it: {figures['lsoda_against_reference_deg']['largest']:.4f} deg at most; "
        f"peak memory {figures['peak_memory_MB']:.0f} MB",
        soft_wrap=True,
    )
    if out is not None:
        (written,) = write_results(out, {"benchmark.json": json.dumps(figures, indent=1) + "\n"})
        output.print(f"figures: {written}", markup=False, soft_wrap=True)
