"""The program that `lanes.compiling` begins: compiles one loop over lanes, beside the work."""

import contextlib
import os
import sys

import numpy as np

from hydrolek_drake.physics.law import LAW
from hydrolek_drake.physics.probes import PROBES
from hydrolek_drake.physics.records import JOINT
from hydrolek_drake.rollout.lanes.compiling import compiled
from hydrolek_drake.rollout.lanes.kinds import kind_of
from hydrolek_drake.rollout.lanes.lanes import one_table
from hydrolek_drake.rollout.run import Run
from hydrolek_drake.rollout.together.lanes import compile_for


def main() -> None:
    """Compile the loop for the joint whose record, and the law whose terms, are on standard input."""
    with contextlib.suppress(OSError, AttributeError):
        os.nice(10)
    given = sys.stdin.buffer.read()
    joint, law = np.frombuffer(given[: JOINT.itemsize], JOINT), np.frombuffer(given[JOINT.itemsize :], LAW)
    spool_steps, probed, together = (int(given) for given in sys.argv[1:4])
    if together:
        compile_for(joint, law if len(law) else None, spool_steps)
        return
    step = 1e-3
    times = np.array([0.0, step])
    probes = (step, np.zeros((2, len(PROBES)))) if probed else None
    every = law if len(law) else None  # that of the joint's own record is among them
    kind = kind_of(joint, spool_steps, every, bool(probed))
    one_table(kind, [Run(joint, times, np.zeros(2), times, step, spool_steps, probes=probes)], [every])
    compiled(kind)


if __name__ == "__main__":
    main()
