"""Strokes of the `ballscrew_faults` recordings as one recording each, for `hydrolek watch`.

Ruiz-Carcel, Starr, Data-based Detection and Diagnosis of Faults in Linear Actuators (2018): set point, position error
and size of the current at 25 Hz. The set point is a ramp; what is held from one sample to the next is its mean there,
and it stands as volts for millimetres. When a stroke was made is not recorded: the names say one a minute.
"""

import argparse
from datetime import datetime, timedelta
from pathlib import Path

import numpy as np
import pandas as pd


def main() -> None:
    """Write the strokes."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("folder", type=Path, help="with normal.csv and others")
    parser.add_argument("--state", default="normal", help="file that is read, without its ending")
    parser.add_argument("--load", type=int, default=20, help="load in kgf: 20, 40 or -40")
    parser.add_argument("--after", type=int, default=0, help="so many strokes after the first of the series")
    parser.add_argument("--out", type=Path, required=True)
    arguments = parser.parse_args()
    table = pd.read_csv(arguments.folder / f"{arguments.state}.csv")
    table = table[table["load"] == arguments.load]
    arguments.out.mkdir(parents=True, exist_ok=True)
    for place, ((run, group), stroke) in enumerate(table.groupby(["run", "group"])):
        points = stroke["set_point"].to_numpy()
        held = points + 0.5 * np.diff(points, append=points[-1])
        written = pd.DataFrame(
            {
                "time_s": stroke["time"].round(6),
                "nut.command_V": held.round(6),
                "nut.position_mm": (points - stroke["position_error"]).round(6),
                "nut.current_A": stroke["current"].round(6),
            }
        )
        at = datetime(2000, 1, 1) + timedelta(minutes=arguments.after + place)
        name = f"{at:%Y%m%dT%H%M}_{arguments.state}_load{arguments.load}_run{run:02d}_{group:03d}.csv"
        written.to_csv(arguments.out / name, index=False)


if __name__ == "__main__":
    main()
