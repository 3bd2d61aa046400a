"""Runs a target in processes of its own, watches over them, and keeps what they failed at."""

import json
import os
import queue
import shutil
import signal
import subprocess
import sys
import tempfile
import threading
import time
from collections import Counter
from collections.abc import Callable
from dataclasses import dataclass, field
from pathlib import Path

from fuzzing.target import put
from fuzzing.targets import target_named

HANG_S = 10.0
"""An input that takes longer has made the reader hang."""
_START_S = 300.0  # for a process to be ready, which may have to compile first
_KEPT = 3  # inputs of each kind of failure


@dataclass
class Failure:
    """An input that was neither read nor refused.

    Attributes:
        index: of the input.
        where: equal for equal failures.
        what: happened, in a line.
        trace: as Python tells it.
    """

    index: int
    where: str
    what: str
    trace: str


@dataclass
class Outcome:
    """What became of the inputs of one target.

    Attributes:
        name: of the target.
        seed: of its inputs.
        inputs: how many were tried.
        became: what -> how many.
        failures: all of them.
        slowest_s: the longest time of one that ended.
        seconds: altogether.
    """

    name: str
    seed: int
    inputs: int = 0
    became: Counter[str] = field(default_factory=Counter)
    failures: list[Failure] = field(default_factory=list)
    slowest_s: float = 0.0
    seconds: float = 0.0

    def line(self) -> str:
        """In one line."""
        became = ", ".join(f"{count} {what}" for what, count in sorted(self.became.items()))
        return (
            f"{self.name}: {self.inputs} inputs ({became}), {len(self.failures)} failures, "
            f"slowest {self.slowest_s:.1f} s, {self.seconds:.0f} s altogether"
        )


class _Child:
    """One process; `next` gives what it tells, or says that it hangs or has ended."""

    def __init__(self, name: str, seed: int, first: int, folder: Path) -> None:
        tests = Path(__file__).resolve().parent.parent
        paths = [str(tests), str(tests.parent), *os.environ.get("PYTHONPATH", "").split(os.pathsep)]
        self._errors = folder.with_suffix(".log").open("w+b")
        self._process = subprocess.Popen(
            [sys.executable, "-m", "fuzzing.child", name, str(seed), str(first), "1", str(folder)],
            stdin=subprocess.DEVNULL,
            stdout=subprocess.PIPE,
            stderr=self._errors,
            env=os.environ
            | {
                "PYTHONPATH": os.pathsep.join(path for path in paths if path),
                "XDG_CACHE_HOME": str(folder.parent),  # units that were tried are not remembered
            },
            start_new_session=True,
        )
        self._told: queue.Queue[bytes] = queue.Queue()
        threading.Thread(target=self._listen, daemon=True).start()

    def _listen(self) -> None:
        assert self._process.stdout is not None
        for line in self._process.stdout:
            self._told.put(line)
        self._told.put(b"")

    def next(self, limit: float) -> dict:
        """What it tells within so many seconds; {"hangs"}, or {"ended"} with its status, if it does not."""
        try:
            line = self._told.get(timeout=limit)
        except queue.Empty:
            self._process.send_signal(signal.SIGUSR1)
            time.sleep(0.5)
            return {"hangs": self.errors()}
        return json.loads(line) if line else {"ended": self._process.wait(), "errors": self.errors()}

    def errors(self) -> str:
        """The end of what it wrote to standard error."""
        self._errors.seek(0)
        return self._errors.read().decode("utf-8", "replace")[-6000:]

    def end(self) -> None:
        """End it and what it has started."""
        try:
            os.killpg(self._process.pid, signal.SIGKILL)
        except ProcessLookupError:
            pass
        self._process.wait()
        self._errors.close()


def run(
    name: str,
    seed: int,
    *,
    count: int | None = None,
    seconds: float | None = None,
    first: int = 0,
    kept_in: Path | None = None,
    tell: Callable[[Outcome], None] = lambda outcome: None,
) -> Outcome:
    """Give inputs to a target until so many are done or the time is up.

    Args:
        name: of the target.
        seed: of its inputs.
        count: how many.
        seconds: how long, if there is no `count`.
        first: number of the first input.
        kept_in: folder to which inputs that failed are written as they come, a few of each kind.
        tell: is told now and then how far it is.

    Raises:
        RuntimeError: a good input is not read, so there is nothing to damage.
    """
    outcome = Outcome(name, seed)
    began = time.monotonic()
    place = Path(tempfile.mkdtemp(prefix="hydrolek_fuzz_"))
    index, last = first, None if count is None else first + count
    try:
        while (last is None or index < last) and (seconds is None or time.monotonic() - began < seconds):
            until = None if seconds is None else began + seconds
            index = _until_it_ends(outcome, index, last, until, place, kept_in, tell)
    finally:
        shutil.rmtree(place, ignore_errors=True)
        outcome.seconds = time.monotonic() - began
    return outcome


def _until_it_ends(
    outcome: Outcome,
    index: int,
    last: int | None,
    until: float | None,
    place: Path,
    kept_in: Path | None,
    tell: Callable[[Outcome], None],
) -> int:
    """Work with one process; returns the number of the input to go on with."""
    child = _Child(outcome.name, outcome.seed, index, place / "input")
    try:
        told = child.next(_START_S)
        if "ready" not in told:
            raise RuntimeError(f"{outcome.name}: its good inputs are not read: {told}")
        while (last is None or index < last) and (until is None or time.monotonic() < until):
            if "renewed" in child.next(HANG_S):  # else it says which input comes
                break
            began = time.monotonic()
            told = child.next(HANG_S)
            taken = time.monotonic() - began
            outcome.inputs += 1
            index += 1
            if "became" in told:
                outcome.became[told["became"]] += 1
                outcome.slowest_s = max(outcome.slowest_s, taken)
            else:
                outcome.failures.append(_failure(index - 1, told))
                if kept_in is not None:
                    _keep(outcome, outcome.failures[-1], kept_in)
            tell(outcome)
            if "hangs" in told or "ended" in told or told.get("where") == "memory":
                break
    finally:
        child.end()
        shutil.rmtree(place / "input", ignore_errors=True)
    return index


def _failure(index: int, told: dict) -> Failure:
    if "hangs" in told:
        stack = told["hangs"]
        ours = [line.strip() for line in stack.splitlines() if "hydrolek_drake" in line]
        return Failure(index, f"hang {ours[0] if ours else ''}", f"took longer than {HANG_S:g} s", stack)
    if "ended" in told:
        status = told["ended"]
        what = signal.Signals(-status).name if status < 0 else f"exit status {status}"
        ours = [line.strip() for line in told["errors"].splitlines() if "hydrolek_drake" in line]
        return Failure(
            index, f"crash {ours[0] if ours else ''}", f"the process ended: {what}", told["errors"]
        )
    return Failure(index, told["where"], told["failed"], told["trace"])


def _keep(outcome: Outcome, failure: Failure, folder: Path) -> None:
    """Write an input that failed, with what makes it again, unless there are enough of its kind."""
    if sum(other.where == failure.where for other in outcome.failures) > _KEPT:
        return
    kept = _place_of(outcome, failure, folder)
    kept.mkdir(parents=True, exist_ok=True)
    put(target_named(outcome.name).input(outcome.seed, failure.index), kept)
    again = f"scripts/fuzz --target {outcome.name} --seed {outcome.seed} --first {failure.index} --count 1"
    (kept / "failure.txt").write_text(f"{again}\n{failure.what}\n\n{failure.trace}\n")


def kinds_of_failure(outcome: Outcome, folder: Path) -> list[str]:
    """A line for each kind of failure, the most frequent first, with the folder of the first input."""
    lines = []
    for where, number in Counter(failure.where for failure in outcome.failures).most_common():
        first = next(failure for failure in outcome.failures if failure.where == where)
        lines.append(f"{number} x {where}: {first.what} ({_place_of(outcome, first, folder)})")
    return lines


def _place_of(outcome: Outcome, failure: Failure, folder: Path) -> Path:
    return folder / f"{outcome.name}_{outcome.seed}_{failure.index}"
