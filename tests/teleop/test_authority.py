"""Who may move the arms over the link: rules on a clock that the test turns."""

import numpy as np
import pytest

from hydrolek_drake.errors import InputError
from hydrolek_drake.teleop.link.authority import Authority, BusyError, Client

_HOME, _THERE = np.zeros(14), np.full(14, 0.1)


class _Clock:
    now = 100.0

    def __call__(self):
        return self.now


@pytest.fixture
def clock():
    return _Clock()


@pytest.fixture
def authority(clock):
    return Authority(_HOME, silence=0.5, mute=2.0, clock=clock)


def test_who_is_silent_closes_the_valves_and_who_is_mute_loses_control(authority, clock):
    first, second = Client(), Client()
    authority.lead(first, angles=_THERE)
    assert authority.order().valves_open
    clock.now += 0.6
    order = authority.order()
    assert not order.valves_open and order.reason == "no message for 0.5 s"
    with pytest.raises(BusyError):
        authority.lead(second, angles=_THERE)
    clock.now += 1.5
    authority.lead(second, angles=_THERE)
    assert authority.in_control(second) and authority.order().valves_open
    with pytest.raises(BusyError):
        authority.lead(first, angles=_THERE)


def test_stop_of_anybody_closes_the_valves_and_nobody_moves_before_he_knows_of_it(authority):
    first, second = Client(), Client(trusted=False)
    authority.lead(first, angles=_THERE)
    authority.stop(second)
    assert not authority.order().valves_open and first.dropped == "stopped by another client"
    again = Client()  # the first one connects anew and goes on as if nothing had happened
    with pytest.raises(BusyError, match="send CONTROL"):
        authority.lead(again, angles=_THERE)
    assert not authority.order().valves_open
    authority.take(again)
    assert not authority.order().valves_open
    authority.lead(again, angles=_THERE)
    assert authority.order().valves_open


def test_an_untrusted_stop_never_takes_control(authority):
    stranger, console = Client(trusted=False), Client()
    authority.stop(stranger)
    authority.take(console)
    assert authority.in_control(console)


def test_the_own_stop_keeps_control(authority):
    console = Client()
    authority.lead(console, deflection=np.full(14, 10.0))
    authority.stop(console)
    order = authority.order()
    assert not order.valves_open and order.deflection is None and authority.in_control(console)
    authority.lead(console, angles=_THERE)
    assert authority.order().valves_open


def test_a_sign_of_life_keeps_what_is_wanted_and_opens_nothing(authority, clock):
    console = Client()
    authority.lead(console)
    assert not authority.order().valves_open
    authority.lead(console, angles=_THERE)
    for _ in range(4):
        clock.now += 0.4
        authority.lead(console)
        assert authority.order().valves_open
    clock.now += 0.6
    authority.lead(console)
    assert not authority.order().valves_open  # too late: it opens nothing again


def test_a_bad_message_of_anybody_closes_the_valves(authority):
    first, second = Client(), Client()
    authority.lead(first, angles=_THERE)
    authority.bad(second, "nonsense")
    assert not authority.order().valves_open and "nonsense" in first.dropped


def test_leaving_frees_control_and_a_watcher_that_leaves_changes_nothing(authority):
    first, second = Client(), Client()
    authority.lead(first, angles=_THERE)
    authority.leave(second, "gone")
    assert authority.order().valves_open
    authority.leave(first, "gone")
    assert authority.order().reason == "gone"
    authority.take(second)
    assert authority.in_control(second)


def test_after_closing_nothing_opens_any_more(authority):
    console = Client()
    authority.lead(console, angles=_THERE)
    authority.close("the link was closed")
    with pytest.raises(InputError, match="closed"):
        authority.lead(console, angles=_THERE)
    authority.leave(console, "gone")
    assert authority.order().valves_open is False and authority.order().reason == "the link was closed"


def test_a_stop_while_nobody_is_in_control_is_known_before_anybody_moves(authority, clock):
    first, stranger = Client(), Client(trusted=False)
    authority.lead(first, angles=_THERE)
    clock.now += 2.1  # it has lost control
    authority.stop(stranger)
    with pytest.raises(BusyError, match="send CONTROL"):
        authority.lead(first, angles=_THERE)
    assert not authority.order().valves_open
    authority.take(first)
    authority.lead(first, angles=_THERE)
    assert authority.order().valves_open
