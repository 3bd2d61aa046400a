"""What the live watch is measured with: a bench of the challenge, ten joints that move at once, a bad link.

The bench is the challenge's (equations and an integrator of its own), so that the fitted model is not the machine.
"""

import numpy as np

from hydrolek_drake.challenge.build import build_of
from hydrolek_drake.challenge.cases import driven, with_concealed
from hydrolek_drake.challenge.drawing import SIZING_STEP_S
from hydrolek_drake.challenge.driving import SAMPLE_S
from hydrolek_drake.recordings import write_signals
from hydrolek_drake.rigs import load_rig
from hydrolek_drake.rollout.onwards import onwards
from hydrolek_drake.watching.live.samples import Samples
from hydrolek_drake.watching.live.settings import LOST

LATEST_S = 0.2
UNITS = {"joint.command": "V", "joint.angle": "rad"}
LEAKAGE = "cylinder.cross_port_leakage"


def bench(leakage=0.0):
    """The challenge's bench with numbers of its own."""
    build = build_of(load_rig("joint_bench"))
    rng = np.random.default_rng(7)
    own = {f: build.rig.value(path) * float(rng.uniform(0.92, 1.08)) for f, path in build.spread.items()}
    machine = build.nominal._replace(**own)
    if leakage:
        machine = with_concealed(machine, {LEAKAGE: {"conductance_m3_per_s_Pa": leakage}})
    return build, machine


def played(build, machine, seconds, seed):
    """Command and rounded, noisy reading of a drive."""
    rng = np.random.default_rng(seed)
    noise, resolution = (build.rig.value(f"sensor.{name}") for name in ("noise", "resolution"))
    done = driven(build, machine, "open", seconds, rng, noise, SIZING_STEP_S)
    reading = done.reading + noise * rng.standard_normal(done.reading.size)
    return done.volts, np.round(reading / resolution) * resolution


def references(out):
    """Files of the reference, made if they are missing."""
    out.mkdir(parents=True, exist_ok=True)
    build, machine = bench()
    paths = [out / f"reference_{number}.csv" for number in range(3)]
    for number, path in enumerate(paths):
        if not path.exists():
            volts, angle = played(build, machine, 40.0, 10 + number)
            time_s = np.arange(volts.size) * SAMPLE_S
            write_signals(path, time_s, {"joint.command": volts, "joint.angle": angle}, UNITS)
    return paths


def spoilt(time_s, volts, angle, rng):
    """Messages in the order in which a bad link brings them: 5 % each lost, doubled and late; and when they come."""
    count = time_s.size
    keep = np.flatnonzero(rng.random(count) >= LOST)
    again = keep[rng.random(keep.size) < LOST]
    order = np.concatenate([keep, again])
    arrival = time_s[order] + 0.002
    late = rng.random(order.size) < LOST
    arrival[late] += rng.uniform(0.0, LATEST_S, late.sum())
    by = np.argsort(arrival, kind="stable")
    order = order[by]
    return Samples(
        time_s[order], {"joint.command": volts[order], "joint.angle": angle[order]}, UNITS
    ), arrival[by]


def random_signals(rig, joint, count, rng):
    """Voltages of signals up to half of the largest, (4.2) and (4.3), held for a second each."""
    least_a, most_a, least_b, most_b = (
        rig.value(f"joints.{joint}.command.calibration_{name}") for name in "abcd"
    )
    signals = rng.uniform(-0.5, 0.5, count // 100 + 1)
    ahead = least_a + signals * (most_a - least_a)
    back = -least_b + signals * (most_b - least_b)
    return np.repeat(np.where(signals > 0.0, ahead, back), 100)[:count]


def ten_joints(rig, seconds, seed):
    """Signals of ten joints of both arms that move at once, of the model itself, and the joints that are stepped."""
    joints = tuple(j for j in rig.joints if j[-2:] in ("j1", "j2", "j3", "j4", "j5"))
    rng = np.random.default_rng(seed)
    time_s = np.arange(0.0, seconds, 0.01)
    volts = np.stack([random_signals(rig, joint, time_s.size, rng) for joint in joints], axis=1)
    (machine,) = onwards(rig, joints, 0.0, {})
    places = [machine.joints.index(joint) for joint in joints]
    neutral = np.array([rig.value(f"joints.{joint}.command.neutral") for joint in machine.joints])
    reading = []
    for now, row in zip(time_s, volts, strict=True):
        reading.append(machine.signals[places][:, [0, 3, 4]])
        full = neutral.copy()
        full[places] = row
        machine.advance(full, now + 0.01)
    noise = np.array([rig.value(f"joints.{joint}.sensor.noise") for joint in joints])
    measured = np.array(reading)
    measured[:, :, 0] += noise * rng.standard_normal(measured.shape[:2])
    measured[:, :, 1:] += 1e4 * rng.standard_normal(measured[:, :, 1:].shape)
    signals = {}
    for place, joint in enumerate(joints):
        signals[f"{joint}.command"], signals[f"{joint}.angle"] = volts[:, place], measured[:, place, 0]
        signals[f"{joint}.pressure_a"] = measured[:, place, 1]
        signals[f"{joint}.pressure_b"] = measured[:, place, 2]
    return time_s, joints, signals, len(machine.joints)
