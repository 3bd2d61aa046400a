"""Recordings a minute of a watch over Dask clusters of one, two and four workers on this computer.

python scripts/watching/cluster_speed.py RUNS REFERENCE [REFERENCE ...] --kept out/watch --out out/cluster

Each cluster asks the same recordings of a bench, against a reference that a watch before has fitted and kept. Workers
load the model and its machine code with a few recordings of their own before the clock starts.
"""

import argparse
import os
import shutil
import time
from pathlib import Path

from distributed import LocalCluster

from hydrolek_drake.identification.search.cluster_jobs import ClusterJobs
from hydrolek_drake.rigs import load_rig
from hydrolek_drake.watching.watch import watch

WORKERS = (1, 2, 4)


def main():
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("runs", type=Path)
    parser.add_argument("reference", type=Path, nargs="+")
    parser.add_argument("--kept", type=Path, required=True, help="folder of a watch with this reference")
    parser.add_argument("--recordings", type=int, default=24)
    parser.add_argument("--out", type=Path, required=True)
    given = parser.parse_args()
    rig, files = load_rig("joint_bench"), sorted(given.runs.glob("*.csv"))
    for workers in WORKERS:
        folder = given.out / f"workers_{workers}"
        folder.mkdir(parents=True, exist_ok=True)
        shutil.copy(given.kept / "reference.json", folder)
        warm, asked = files[-2 * workers :], files[: given.recordings]
        with (
            LocalCluster(workers, threads_per_worker=1, dashboard_address=None, silence_logs=50) as made,
            ClusterJobs(made.scheduler_address) as cluster,
        ):
            watch(rig, given.reference, warm, folder=folder, cores=1, cluster=cluster)
            begun = time.monotonic()
            watched = watch(rig, given.reference, asked, folder=folder, cores=1, cluster=cluster)
            seconds = time.monotonic() - begun
        print(
            f"{workers} workers: {watched.anew} recordings in {seconds:.1f} s, {60.0 * watched.anew / seconds:.0f} a "
            f"minute; load {os.getloadavg()[0]:.1f}",
            flush=True,
        )


if __name__ == "__main__":
    main()
