"""Feedforward rate control: its parts and its difference equation, on SDP models."""

import numpy as np
import pytest

from hydrolek_drake.control.closed_loop import loop_on_model
from hydrolek_drake.control.comparison.metrics import step_measures
from hydrolek_drake.control.laws.feedforward_tuning import limit
from hydrolek_drake.control.laws.rate_map import map_from_model, rate_at, voltage_for
from hydrolek_drake.control.models.sdp_model import thesis_model

JOINTS = ("j1", "j2", "j3", "j4")


@pytest.mark.parametrize("joint", JOINTS)
@pytest.mark.parametrize("sign", (-1.0, 1.0))
def test_the_rate_map_inverts_the_law_it_comes_from(joint, sign):
    model = thesis_model(joint)
    side = map_from_model(model).side(sign)
    for rate in np.linspace(0.5, 0.95 * side.fastest, 12):
        voltage = voltage_for(side, rate)
        assert rate_at(side, voltage) == pytest.approx(rate)
        assert abs(float(model.rate(sign * voltage))) == pytest.approx(rate, rel=0.02, abs=0.1)


@pytest.mark.parametrize("joint", JOINTS)
def test_on_the_model_it_was_made_for_it_lands_on_the_set_point(modelled, joint):
    law, model = modelled(joint)
    for target in (20.0, -8.0):
        signals = loop_on_model(law, model, np.full(100, target), 0.05)
        measures = step_measures(signals.time_s, signals.angle_deg, 0.0, target, last_s=2.0, still_deg=0.01)
        assert measures.error_deg <= law.tuning.start_beyond_deg
        assert measures.overshoot_percent < 3.0
        assert np.all(signals.voltage_V[-200:] == 0.0)


def test_a_steadily_moving_set_point_is_followed_without_lag(modelled):
    law, model = modelled("j2")
    wanted = 8.0 * np.arange(80) * 0.05
    signals = loop_on_model(law, model, wanted, 0.05)
    between = 8.0 * signals.time_s[300:]  # the set point also between its samples
    assert np.max(np.abs(signals.angle_deg[300:] - between)) < 0.01


def test_the_difference_equation_written_out_plainly(modelled):
    """One sample at a time, with the map as straight lines: the same voltages."""
    law, model = modelled("j2")
    t, tune = 0.05, law.tuning
    side = {s: law.map.side(s) for s in (-1.0, 1.0)}
    share, edge, late = {-1.0: 1.0, 1.0: 1.0}, {-1.0: 0.0, 1.0: 0.0}, {-1.0: 0.0, 1.0: 0.0}
    sent, estimates = [0.0] * 12, [0.0] * 3  # newest first
    standing, push, landing = 0, 0.0, None
    known, jog, jogged = {-1.0: False, 1.0: False}, 0, {}
    rng = np.random.default_rng(8)
    state, angle, plant, before, slope_before = law.initial(0.0), 0.0, 0.0, 0.0, 0.0

    def rate(v):
        if v == 0.0:
            return 0.0
        s = float(np.sign(v))
        return s * share[s] * float(np.interp(abs(v) - edge[s], side[s].voltages, side[s].rates))

    for k in range(240):
        wanted = 0.0 if k < 1 else 25.0 if k < 60 else -6.0 if k < 120 else 2.0 if k < 180 else 27.0
        measured = plant + float(rng.normal(0.0, 0.05))
        rates = [rate(v) for v in sent]
        first = int(law.map.dead_time_s / t + 1e-9)
        moving = ([r for r in rates[: first + 2] if r != 0.0] or [0.0])[-1]
        dead = law.map.dead_time_s + late[1.0 if moving > 0.0 else -1.0]
        whole = int(dead / t + 1e-9)
        rest = dead / t - whole
        # estimate: all of a deviation beyond the band, a share of the rest
        acted = (1 - rest) * rates[whole] + rest * rates[whole + 1]
        angle += t * acted
        off = measured - angle
        small = float(np.clip(off, -limit("band"), limit("band")))
        taken = tune.correction * small + (off - small)
        angle += taken
        moved = angle - estimates[2]
        # rates and edges
        acting = rates[whole : whole + 4]
        if min(acting) * max(acting) >= 0.0 and any(acting):
            s = float(np.sign(sum(acting)))
            saturated = limit("saturated") * side[s].fastest * share[s]
            expected, got = abs(np.mean(acting)), s * moved / (3 * t)
            if min(map(abs, acting)) >= saturated:
                ratio = float(np.clip(got / expected, 0.0, limit("share")))
                share[s] = float(np.clip(share[s] * (1 + tune.learn_rate * (ratio - 1)), 0.5, 2.0))
            elif max(map(abs, acting)) < saturated:
                slope = side[s].rates[1] / (side[s].voltages[1] - side[s].voltages[0])
                i = whole + 1 + round(rest)
                if max(map(abs, rates[i : i + 4])) < saturated:
                    found = edge[s] + tune.learn_edge * (expected - got) / slope
                    should = s * t * (rates[i] + rates[i + 1])
                    if should >= limit("stalled") and s * moved < limit("standing") * should:
                        found = max(found, min(abs(sent[i]), abs(sent[i + 1])) - side[s].voltages[0])
                    edge[s] = float(np.clip(found, -0.5 * side[s].voltages[0], side[s].voltages[0]))
        # push
        should = t * sum(rates[whole : whole + 3])
        if abs(should) >= limit("stuck") and np.sign(should) * moved < limit("standing") * abs(should):
            push += t * tune.push * abs(wanted - angle) / (law.map.dead_time_s + 3 * t) ** 2
        else:
            push = 0.0
        # arrival
        slope = (wanted - before) / t
        velocity = slope if abs(slope - slope_before) <= limit("slope_change") and k else 0.0
        ahead = angle + t * (sum(rates[:whole]) + rest * rates[whole])
        distance = wanted + velocity * dead - ahead
        mean = (angle + sum(estimates)) / 4
        hold, same = whole + 4, wanted == before
        s = 1.0 if sum(rates) >= 0.0 else -1.0
        full = limit("saturated") * side[s].fastest * share[s]
        braked = s * rates[2] >= full and max(s * rates[0], s * rates[1]) < full
        if velocity != 0.0:
            standing = 0
        elif standing and same:
            standing += 1
            if standing > hold and abs(wanted - mean) > tune.start_beyond_deg:
                standing = 0
        elif abs(distance) <= tune.stop_within_deg or (same and moving * distance < 0.0) or braked:
            standing = 1
        else:
            standing = 0
        # voltage
        if standing:
            v = 0.0
            if standing <= hold:
                s = 1.0 if sent[0] > 0.0 else -1.0
                v = s * min(abs(sent[0]), tune.closed * (side[s].voltages[0] + edge[s]))
        else:
            s = float(np.sign(distance))
            fast = side[s].fastest * share[s]
            left = max(abs(distance) - tune.landing_s * fast, 0.0)
            saturated = [s * r >= limit("saturated") * fast for r in rates[:2]]
            if left > tune.braking * fast * t * (1.0 if saturated[0] else tune.starting):
                want = 2.0 * fast
            elif any(saturated):
                want = left / t / (2 if saturated[0] else 1)
            else:
                want = min(tune.gain * abs(distance) + push, fast)
            if velocity == 0.0:
                want = max(want, tune.slowest)
            want = float(np.clip(s * want + velocity, -2.0 * side[s].fastest, 2.0 * side[s].fastest))
            s = float(np.sign(want))
            v = float(np.interp(abs(want) / share[s], side[s].rates, side[s].voltages)) + edge[s]
            if abs(want) / share[s] >= side[s].fastest:
                v = side[s].voltages[-1] + max(edge[s], tune.reserve * side[s].voltages[0])
            v = s * min(v, 10.0)
        # jog
        s = float(np.sign(distance))
        large = not known[s] and abs(distance) >= limit("jog_from") and not any(rates)
        if not standing and same and velocity == 0.0 and (jog or large):
            opens, main = side[s].voltages[0], v
            shut = tune.closed * (opens + edge[s])
            if jog <= 0 and s * sent[0] < shut:
                v = s * shut
            elif jog <= 0:
                way = min(limit("jog_share") * abs(distance), limit("jog_most"))
                volts = float(np.interp(way / (2 * t * share[s]), side[s].rates, side[s].voltages))
                volts = edge[s] + min(volts, 1.3 * opens)
                base = jogged["base"] if jog == -1 else mean
                jogged = {"base": base, "ways": [], "V": volts, "edge": edge[s], "again": jog == -1}
                jog, v = 1, s * volts
            else:
                jog += 1
                jogged["ways"].append(s * (measured - jogged["base"]))
                since, done = jog - 1, 2 + whole + 1
                was = np.interp(jogged["V"] - jogged["edge"], side[s].voltages, side[s].rates)
                expected = 2 * t * share[s] * float(was)
                if since == done and jogged["ways"][-1] >= limit("standing") * expected:
                    known[s] = True
                v = main if known[s] else s * (jogged["V"] if since < 2 else shut)
                if since >= done and since == done + (whole if known[s] else limit("jog_wait")):
                    got = float(np.mean(jogged["ways"][done - 1 :]))
                    found = jogged["edge"]
                    longer = got > limit("jog_more") * expected and not jogged["again"]
                    if longer or got < limit("jog_less") * expected:
                        seen = max(got, limit("jog_unseen")) / (2 * t * share[s])
                        found = jogged["V"] - float(np.interp(seen, side[s].rates, side[s].voltages))
                    edge[s] = float(np.clip(found, -0.5 * opens, opens))
                    if got < limit("standing") * expected and edge[s] < opens and not known[s]:
                        jog, v = -1, s * tune.closed * (opens + edge[s])
                        jogged["base"] += s * got
                    else:
                        if got >= limit("jog_less") * expected:
                            after = 0.5 + sum(1.0 - way / got for way in jogged["ways"])
                            late[s] = float(np.clip(t * after - t - law.map.dead_time_s, 0.0, limit("late")))
                        known[s], jog = True, 0
                        if not known[-s]:
                            edge[-s] = float(edge[s] / opens * side[-s].voltages[0])
                        v = side[s].voltages[-1] + max(edge[s], tune.reserve * opens)
                        v = s * min(v, 10.0)  # the step itself: far off, at saturation
        else:
            jog = 0
        if v * sent[0] < 0.0 or abs(v) < abs(sent[0]):
            s = float(np.sign(sent[0]))
            closed = tune.closed * (side[s].voltages[0] + edge[s])
            v = s * max(s * v, closed if abs(sent[0]) > closed else abs(sent[0]) - tune.crossing_V)
        elif v != 0.0:
            s = float(np.sign(v))
            end = side[s].voltages[0] + edge[s]
            ready = abs(sent[0]) >= tune.closed * end - 1e-9
            v = s * min(
                abs(v), abs(sent[0]) + tune.opening_V if ready else min(abs(sent[0]) + tune.crossing_V, end)
            )
        # dead time from a stop
        if standing == 1 and braked:
            landing = (ahead, rates[2])
        elif standing == 0:
            landing = None
        elif standing >= hold and landing:
            s = float(np.sign(landing[1]))
            found = late[s] + tune.learn_landing * (mean - landing[0]) / landing[1]
            late[s], landing = float(np.clip(found, 0.0, limit("late"))), None
        state, _, voltage = law.step(state, wanted, measured)
        assert voltage == pytest.approx(v, abs=1e-9), k
        sent, estimates = [voltage, *sent[:-1]], [angle, *estimates[:-1]]
        before, slope_before = wanted, slope
        for i in range(5):
            past = k * 5 + i + 1 - model.delay_samples
            back = k - past // 5 if past >= 0 else 11
            plant = model.step(plant, sent[back] if back < 12 else 0.0)


@pytest.mark.parametrize("joint", JOINTS)
def test_the_voltage_opens_by_bounded_steps_and_closes_at_once(modelled, joint):
    law, model = modelled(joint)
    signals = loop_on_model(law, model, np.repeat([20.0, -10.0, 10.0], 100), 0.05)
    voltage = np.concatenate([[0.0], signals.voltage_V[::5]])
    tune = law.tuning
    opened = np.abs(voltage[1:]) - np.abs(voltage[:-1])
    assert np.max(opened) <= tune.opening_V + 1e-9
    within = np.abs(voltage[:-1]) < tune.closed * min(law.map.side(s).edge_V for s in (-1.0, 1.0)) - 0.1
    assert np.max(np.abs(np.diff(voltage))[within]) <= tune.crossing_V + 1e-9
    for k in np.flatnonzero(signals.output[::5] == 0.0):  # wanted: to stand
        sign = np.sign(voltage[k + 1])
        assert abs(voltage[k + 1]) < law.map.side(sign).edge_V
