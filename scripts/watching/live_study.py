"""The live watch measured: processor share, two hours with a bad link, gaps and jumps, and faults that begin.

python scripts/watching/live_study.py share                     # ten joints at 100 Hz, processor time a second
python scripts/watching/live_study.py prepare --out out/live    # three references of the bench, fitted
python scripts/watching/live_study.py stream --out out/live     # two hours, 5 % each lost, doubled, late, at full pace
python scripts/watching/live_study.py faults --out out/live     # leakages that begin after a minute
python scripts/watching/live_study.py pump                      # a leakage in one of ten joints that share a pump
python scripts/watching/live_study.py named --out out/live      # a leakage over TCP, named by windows

Machines and the link are those of `live_machines`.
"""

import argparse
import json
import resource
import socket
import subprocess
import sys
import time
from pathlib import Path

import numpy as np
from live_machines import LEAKAGE, UNITS, bench, played, references, spoilt, ten_joints

from hydrolek_drake.challenge.driving import SAMPLE_S
from hydrolek_drake.recordings import Recording, read_recording
from hydrolek_drake.rigs import load_rig
from hydrolek_drake.watching.live.blocks import healthy_of
from hydrolek_drake.watching.live.following import Follower
from hydrolek_drake.watching.live.running import fitted_rig
from hydrolek_drake.watching.live.samples import Samples
from hydrolek_drake.watching.watch import drifts_of, watch

FALSE_ALARMS = 0.005
PIECE_S = 600.0


def prepared(out):
    """Fitted rig and what healthy innovations are like."""
    paths, rig = references(out), load_rig("joint_bench")
    watch(rig, paths, [], folder=out / "watch", cores=1)
    fitted, joints = fitted_rig(rig, paths, out / "watch", drifts_of(None))
    return fitted, healthy_of(fitted, joints, [read_recording(path) for path in paths])


def fed(follower, samples, arrival, at_a_time=50):
    """Hand messages on in small parts, as they come."""
    for first in range(0, samples.time.size, at_a_time):
        part = slice(first, first + at_a_time)
        signals = {key: values[part] for key, values in samples.signals.items()}
        follower.take(Samples(samples.time[part], signals, UNITS), float(arrival[part][-1]), time.time())


def memory_mb():
    """What this process takes now [MB]."""
    pages = int(Path("/proc/self/statm").read_text().split()[1])
    return pages * resource.getpagesize() / 1e6


def stream(out, hours):
    """A healthy machine for hours over a bad link."""
    fitted, healthy = prepared(out)
    windows = []
    follower = Follower(fitted, healthy, FALSE_ALARMS, on_window=lambda w: windows.append(w.time.size))
    build, machine = bench()
    rng, begin, memory = np.random.default_rng(5), 0.0, []
    for number in range(round(hours * 3600.0 / PIECE_S)):
        volts, angle = played(build, machine, PIECE_S, 1000 + number)
        time_s = begin + np.arange(volts.size) * SAMPLE_S
        spent = time.process_time()
        fed(follower, *spoilt(time_s, volts, angle, rng))
        spent = time.process_time() - spent
        begin = float(time_s[-1]) + 60.0  # the machine is set up anew: a gap of a minute
        memory.append(memory_mb())
        evidence = float(np.nanmax(follower.detector.evidence))
        print(
            f"{begin:.0f} s: {memory[-1]:.1f} MB, {1e3 * spent / PIECE_S:.2f} ms processor time a second, evidence "
            f"{evidence:.1f} of {follower.detector.threshold:.1f}, windows {len(windows)}, {follower.alarm_text!r}, "
            f"{json.dumps(follower.merger.counts.as_dict())}, events {follower.happened}",
            flush=True,
        )


def faults(out):
    """Leakages that begin after a minute of health, and gaps and jumps of the clock before."""
    fitted, healthy = prepared(out)
    for leakage in (0.0, 2e-14, 5e-14, 1e-13, 2e-13, 4e-13):
        follower = Follower(fitted, healthy, FALSE_ALARMS)
        rng = np.random.default_rng(6)
        begin = 0.0
        for seconds, size, seed, jump in (
            (30.0, 0.0, 21, 5.0),
            (30.0, 0.0, 22, -20.0),
            (120.0, leakage, 23, 0.0),
        ):
            volts, angle = played(*bench(size), seconds, seed)
            time_s = begin + np.arange(volts.size) * SAMPLE_S
            fed(follower, *spoilt(time_s, volts, angle, rng))
            onset = begin
            begin = float(time_s[-1]) + jump
        events = "; ".join(f"{e.time:.2f} s {e.text}" for e in follower.events)
        when = follower.detector.alarmed
        after = "never" if when is None else f"{when - onset:.1f} s"
        print(f"leakage {leakage:g} m^3/(s Pa): alarmed after {after}; {events}", flush=True)


def ten_healthy(rig, seconds):
    """What innovations of ten healthy joints are like, by three recordings."""
    recordings = []
    for seed in (3, 13, 23):
        time_s, joints, signals, _ = ten_joints(rig, seconds, seed)
        recordings.append(Recording(f"made {seed}", time_s, signals, Path("made.csv")))
    return healthy_of(rig, joints, recordings)


def followed(follower, begin, time_s, signals):
    """Hand ten joints' samples on, five at a time."""
    for first in range(0, time_s.size, 5):
        part = {key: values[first : first + 5] for key, values in signals.items()}
        follower.take(Samples(begin + time_s[first : first + 5], part), None, time.time())


def share(seconds):
    """Ten joints of both arms that move at once."""
    rig = load_rig("hydrolek")
    follower = Follower(rig, ten_healthy(rig, seconds), FALSE_ALARMS)
    time_s, joints, signals, stepped = ten_joints(rig, seconds, 4)
    spent = time.process_time()
    followed(follower, 0.0, time_s, signals)
    spent = time.process_time() - spent
    print(f"{len(joints)} joints ({stepped} stepped): {100 * spent / time_s[-1]:.1f} % of a core")
    print(f"alarm: {follower.alarm_text!r}")


def pump(seconds):
    """A leakage in one of ten joints that share a pump: which of them are alarmed?"""
    rig = load_rig("hydrolek")
    healthy = ten_healthy(rig, seconds)
    for leakage in (0.0, 2e-13, 1e-12, 5e-12):
        follower = Follower(rig, healthy, FALSE_ALARMS)
        begin = 0.0
        for size, seed in ((0.0, 4), (leakage, 5)):
            worn = rig.with_values(
                {f"joints.right_j2.effects.{LEAKAGE}.conductance_m3_per_s_Pa": size} if size else {}
            )
            time_s, joints, signals, _ = ten_joints(worn, seconds, seed)
            followed(follower, begin, time_s, signals)
            onset, begin = begin, begin + float(time_s[-1]) + 60.0
        told = np.nanmax(follower.detector.evidence, axis=(0, 2))
        beyond = [j for j, e in zip(joints, told, strict=True) if e >= follower.detector.threshold]
        when = follower.detector.alarmed
        after = "never" if when is None else f"after {when - onset:.1f} s: {follower.alarm_text}"
        print(
            f"right_j2 leaks {leakage:g} m^3/(s Pa): alarmed {after}; beyond at the end: {beyond}", flush=True
        )
        others = max(e for j, e in zip(joints, told, strict=True) if j != "right_j2")
        print(f"  largest evidence of another joint {others:.1f} of {follower.detector.threshold:.1f}")


def named(out, pace, minutes, leakage):
    """A leakage over TCP, so many times as fast as the machine: alarmed by windows, by name? By `hydrolek watch`."""
    parts, begin = [], 0.0
    for seconds, size, seed in ((120.0, 0.0, 31), (60.0 * minutes, leakage, 32)):
        volts, angle = played(*bench(size), seconds, seed)
        time_s = begin + np.arange(volts.size) * SAMPLE_S
        parts.append(np.stack([time_s, volts, angle], axis=1))
        begin = float(time_s[-1]) + 60.0
    rows = np.concatenate(parts)
    with socket.socket() as probe:
        probe.bind(("127.0.0.1", 0))
        port = probe.getsockname()[1]
    live = ["--live", f"tcp://127.0.0.1:{port}", "--port", "0", "--idle", "20", "--workers", "1"]
    start = "import sys; from hydrolek_drake.cli.app import main; sys.exit(main())"
    command = [sys.executable, "-c", start, "watch", "joint_bench"]
    told = subprocess.Popen([*command, *map(str, references(out)), *live, "--out", str(out / "named")])
    sender, until = None, time.monotonic() + 120.0
    while sender is None:
        try:
            sender = socket.create_connection(("127.0.0.1", port))
        except OSError:
            if time.monotonic() > until or told.poll() is not None:
                raise
            time.sleep(0.2)
    sender.sendall(b"time_s,joint.command_V,joint.angle_rad\n")
    begun = time.monotonic()
    for row in rows:
        sender.sendall(f"{row[0]:.3f},{row[1]:.6f},{row[2]:.6f}\n".encode())
        ahead = row[0] / pace - (time.monotonic() - begun)
        if ahead > 0.01:
            time.sleep(ahead)
    sender.close()
    print("exit status", told.wait())


if __name__ == "__main__":
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("what", choices=("share", "prepare", "stream", "faults", "pump", "named"))
    parser.add_argument("--out", type=Path, default=Path("out/live"))
    parser.add_argument("--hours", type=float, default=2.0)
    parser.add_argument("--seconds", type=float, default=60.0)
    parser.add_argument("--pace", type=float, default=8.0)
    parser.add_argument("--minutes", type=float, default=8.0)
    parser.add_argument("--leakage", type=float, default=4e-13)
    given = parser.parse_args()
    if given.what == "share":
        share(given.seconds)
    elif given.what == "pump":
        pump(given.seconds)
    elif given.what == "named":
        named(given.out, given.pace, given.minutes, given.leakage)
    elif given.what == "prepare":
        print(prepared(given.out)[1])
    elif given.what == "stream":
        stream(given.out, given.hours)
    else:
        faults(given.out)
