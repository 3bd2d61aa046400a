"""Threads whose rollouts are made in lanes together, whatever each of them is busy with.

A fit asks for one rollout after the other: residuals of a trial step cannot be had before the step is known, and a
Jacobian's columns seldom fill whole tables of lanes. Fits of other structures or from other places ask for theirs at
the same time. So there are more threads than cores; each hands in what it wants to be rolled out and waits, and what
all of them wait for is rolled out in full tables. What a fit finds does not depend on it, since every lane does what
its machine does alone.
"""

import contextlib
import threading
import time
from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import Future, ThreadPoolExecutor
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from hydrolek_drake.rollout.lanes.lanes import FEW, compiled_kind_of, one_table, together_with
from hydrolek_drake.rollout.lanes.view import LANES, Kind
from hydrolek_drake.rollout.rollout import Outcome, with_own
from hydrolek_drake.rollout.run import Run

PATIENCE_S = 3e-3
"""So long a rollout waits for others of its kind while a core is idle: less than the rollout of some seconds takes."""


class RolloutPool(ThreadPoolExecutor):
    """Threads for work of which most is rollouts."""

    def __init__(self, cores: int) -> None:
        """Begin.

        Args:
            cores: tables that are rolled out at the same time.
        """
        super().__init__(cores * LANES)
        self._tables = Tables(cores)

    def submit(self, work: Callable[..., Any], /, *given: Any, **named: Any) -> Future[Any]:
        """As of `Executor`; what the work rolls out goes into tables with what other work does."""
        return super().submit(self._tables.shared_by, work, *given, **named)


@dataclass(eq=False)
class _Asked:
    """What a thread waits for.

    Attributes:
        left: rollouts that are not done yet.
    """

    left: int


@dataclass(eq=False)
class _Wanted:
    """A rollout that is waited for."""

    run: Run
    law: np.ndarray | None
    kind: Kind | None
    asked: _Asked
    since: float = field(default_factory=time.monotonic)
    outcome: Outcome | None = None
    error: Exception | None = None


class Tables:
    """What several threads want to be rolled out, and who does it: those that wait."""

    def __init__(self, cores: int) -> None:
        """Prepare.

        Args:
            cores: tables that are rolled out at the same time.
        """
        self._changed = threading.Condition()
        self._idle, self._working = cores, 0
        self._wanted: dict[Kind | None, list[_Wanted]] = {}

    def shared_by(self, work: Callable[..., Any], /, *given: Any, **named: Any) -> Any:
        """Do some work of this thread, whose rollouts are made with those of others."""
        with together_with(self), self._counted(1):
            return work(*given, **named)

    @contextlib.contextmanager
    def waiting(self) -> Iterator[None]:
        """While this thread waits for another one, and so asks for no rollouts."""
        with self._counted(-1):
            yield

    @contextlib.contextmanager
    def _counted(self, by: int) -> Iterator[None]:
        with self._changed:
            self._working += by
            self._changed.notify_all()
        try:
            yield
        finally:
            with self._changed:
                self._working -= by
                self._changed.notify_all()

    def roll_out(self, runs: Sequence[Run]) -> list[Outcome]:
        """What machines do, see `roll_out_lanes`; this thread works on tables of all until they are done."""
        asked = _Asked(len(runs))
        wanted = []
        for run in runs:
            law = with_own(run.law, run.joint)
            wanted.append(_Wanted(run, law, compiled_kind_of(run, law), asked))
        if not wanted:
            return []
        with self._changed:
            for each in wanted:
                self._wanted.setdefault(each.kind, []).append(each)
            self._working -= 1  # until its rollouts are done: `_done` counts it again, before it has woken
            self._changed.notify_all()
        while (table := self._next(asked)) is not None:
            try:
                _made(table)
            finally:
                self._done(table)
        for each in wanted:
            if each.error is not None:
                raise each.error
        return [each.outcome for each in wanted if each.outcome is not None]

    def _done(self, table: Sequence[_Wanted]) -> None:
        """Those who have all that they asked for work again; who is slow to wake is waited for all the same."""
        with self._changed:
            self._idle += 1
            for each in table:
                each.asked.left -= 1
                self._working += each.asked.left == 0
            self._changed.notify_all()

    def _next(self, asked: _Asked) -> list[_Wanted] | None:
        """A table that this thread is to roll out, as soon as there is one; None once its own rollouts are done."""
        with self._changed:
            while asked.left > 0:
                if self._idle > 0 and (waiting := self._due()) is not None:
                    many = waiting[0].kind is not None and len(waiting) > FEW
                    table = waiting[: LANES if many else 1]
                    del waiting[: len(table)]
                    self._idle -= 1
                    return table
                self._changed.wait(PATIENCE_S)
            return None

    def _due(self) -> list[_Wanted] | None:
        """Machines of one kind that are to be rolled out next; None if it is better to wait for more of them."""
        oldest: list[_Wanted] | None = None
        for kind, waiting in self._wanted.items():
            if len(waiting) >= LANES or (kind is None and waiting):
                return waiting
            if waiting and (oldest is None or waiting[0].since < oldest[0].since):
                oldest = waiting
        if oldest is None:
            return None
        patient = self._working > 0 and time.monotonic() - oldest[0].since < PATIENCE_S
        return None if patient else oldest


def _made(table: list[_Wanted]) -> None:
    """Roll out a table; what cannot be rolled out is told to who waits for it."""
    kind = table[0].kind
    if kind is not None and len(table) > FEW:
        with contextlib.suppress(Exception):  # one of them cannot be: which, is found one by one
            done = one_table(kind, [each.run for each in table], [each.law for each in table])
            for each, outcome in zip(table, done, strict=True):
                each.outcome = outcome
            return
    for each in table:
        try:
            each.outcome = each.run.outcome()
        except Exception as error:
            each.error = error
