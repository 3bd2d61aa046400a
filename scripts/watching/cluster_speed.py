"""Recordings a minute of a watch, and cases of a challenge, over Dask clusters of one, two and four workers here.

python scripts/watching/cluster_speed.py RUNS REFERENCE [REFERENCE ...] --kept out/watch --out out/cluster --cases 4

Each cluster asks the same recordings of a bench, against a reference that a watch before has fitted and kept. Workers
load the model and its machine code with a few recordings of their own before the clock starts. The challenge's cases
have one effect each, and are the same for all clusters; workers have loaded what they need by the watch before.
"""

import argparse
import os
import shutil
import time
from pathlib import Path

from distributed import LocalCluster

from hydrolek_drake.cli.app import run
from hydrolek_drake.identification.search.cluster_jobs import ClusterJobs
from hydrolek_drake.rigs import load_rig
from hydrolek_drake.watching.watch import watch

WORKERS = (1, 2, 4)


def challenged(cases, seed, out, address, workers):
    """Cases a minute of a challenge."""
    shutil.rmtree(out, ignore_errors=True)
    begun = time.monotonic()
    drawn = ["--cases", str(cases), "--seed", str(seed), "--kind", "single"]
    status = run(["challenge", *drawn, "--cluster", address, "--out", str(out)])
    seconds = time.monotonic() - begun
    print(
        f"{workers} workers: {cases} cases in {seconds:.0f} s, {60.0 * cases / seconds:.1f} a minute, exit status "
        f"{status}; load {os.getloadavg()[0]:.1f}",
        flush=True,
    )


def main():
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("runs", type=Path)
    parser.add_argument("reference", type=Path, nargs="+")
    parser.add_argument("--kept", type=Path, required=True, help="folder of a watch with this reference")
    parser.add_argument("--recordings", type=int, default=24)
    parser.add_argument("--cases", type=int, default=0, help="of a challenge; none without")
    parser.add_argument("--seed", type=int, default=3, help="of these")
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
                f"{workers} workers: {watched.anew} recordings in {seconds:.1f} s, {60.0 * watched.anew / seconds:.0f} "
                f"a minute; load {os.getloadavg()[0]:.1f}",
                flush=True,
            )
            if given.cases:
                challenged(
                    given.cases,
                    given.seed,
                    given.out / f"challenge_{workers}",
                    made.scheduler_address,
                    workers,
                )


if __name__ == "__main__":
    main()
