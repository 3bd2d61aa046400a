"""EMPS by inverse dynamics: least squares of the motor force on acceleration, speed, its sign, and a constant.

The published reference values come from regressing force, not from simulating position (Janot, Gautier, Brunot 2019).
"""

import argparse
from pathlib import Path

import numpy as np
from scipy.signal import butter, decimate, filtfilt

from hydrolek_drake.recordings import read_recording
from hydrolek_drake.rigs import load_rig


def main() -> None:
    """Print the estimates and how far they are off the rig's published values."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("recordings", nargs="+", type=Path)
    parser.add_argument("--cutoff", type=float, default=60.0, help="of the Butterworth filter [Hz]")
    parser.add_argument("--decimation", type=int, default=20, help="samples to one equation")
    arguments = parser.parse_args()
    rig = load_rig("emps_published")
    published = {
        path: rig.value(path)
        for path in (
            "load.inertia",
            "load.damping",
            "joints.axis.effects.load.coulomb_friction.force_N",
            "joints.axis.effects.load.offset_force.force_N",
        )
    }
    for path in arguments.recordings:
        recording = read_recording(path, rig.columns)
        step = float(np.median(np.diff(recording.time)))
        # forwards and backwards, so that position, speed and acceleration are not delayed
        smooth = butter(4, 2.0 * arguments.cutoff * step)
        speed = np.gradient(filtfilt(*smooth, recording.signal("axis.position")), step)
        columns = [np.gradient(speed, step), speed, np.sign(speed), np.ones_like(speed)]
        force = rig.value("cylinder.force_constant") * recording.signal("axis.command")
        # the same low-pass on both sides of the equation keeps it true
        *known, wanted = [decimate(c, arguments.decimation, ftype="fir") for c in (*columns, force)]
        found = np.linalg.lstsq(np.stack(known, axis=1), wanted, rcond=None)[0]
        print(path.name)
        for (name, value), estimate in zip(published.items(), found, strict=True):
            print(f"  {name}: {estimate:.4f}, {100.0 * (estimate / value - 1.0):+.2f} % off {value}")


if __name__ == "__main__":
    main()
