"""Steps are told at once, how they stand now and then, and no silence is long."""

import threading

from hydrolek_drake.cli.telling import Telling, kept_alive

EVERY_S = 10.0


class _Clock:
    """A clock that is set."""

    def __init__(self) -> None:
        self.now = 0.0

    def __call__(self) -> float:
        return self.now


def _telling() -> tuple[Telling, list[str], _Clock]:
    lines: list[str] = []
    clock = _Clock()
    return Telling(lines.append, EVERY_S, clock), lines, clock


def test_every_step_is_told_and_how_it_stands_only_now_and_then() -> None:
    telling, lines, clock = _telling()
    telling("fitting ...")
    for second in range(1, 31):
        clock.now = float(second)
        telling.more(f"round {second}")
    assert lines == ["fitting ...", *(f"fitting ... for {n} s: round {n}" for n in (10, 20, 30))]
    telling("writing ...")
    assert lines[-1] == "writing ..."


def test_a_silent_step_is_told_to_go_on_with_what_was_last_known_of_it() -> None:
    telling, lines, clock = _telling()
    telling.still()
    clock.now = 12.0
    telling.still()
    assert lines == []  # nothing has begun
    telling("weighing ...")
    clock.now = 15.0
    telling.more("round 1")
    clock.now = 23.0
    telling.still()
    telling.still()
    assert lines == ["weighing ...", "weighing ... for 11 s: round 1"]
    telling("next ...")
    clock.now = 40.0
    telling.still()
    assert lines[-1] == "next ... for 17 s"  # how the step before it stood says nothing of this one


def test_a_step_that_is_over_at_once_is_not_told_and_one_that_lasts_is() -> None:
    lines: list[str] = []
    clock = _Clock()
    telling = Telling(lines.append, EVERY_S, clock, first="checking")
    clock.now = 9.0
    telling.still()
    telling.more("half")
    assert lines == []
    clock.now = 11.0
    telling.still()
    assert lines == ["checking for 11 s: half"]


def test_a_thread_keeps_it_alive_until_the_end() -> None:
    enough, lines = threading.Event(), []

    def write(line: str) -> None:
        lines.append(line)
        if len(lines) > 3:
            enough.set()

    with kept_alive(Telling(write, 0.0), 0.001) as telling:
        telling("waiting ...")
        assert enough.wait(30.0)
    count = len(lines)
    assert all(line.startswith("waiting ... for 0 s") for line in lines[1:])
    assert threading.Event().wait(0.02) is False and len(lines) == count
