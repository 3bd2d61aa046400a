"""The process in which inputs are read: it may crash or hang, and tells which input it is at before each of them.

`python -m fuzzing.child TARGET SEED FIRST STEP FOLDER` reads the inputs FIRST, FIRST + STEP, ... until it is ended, and
writes lines of JSON: {"ready"}, {"at"}, {"became"} or {"failed", "where", "trace"}.
"""

import faulthandler
import itertools
import json
import resource
import shutil
import signal
import sys
import traceback
import warnings
from pathlib import Path

from fuzzing.target import judged, put
from fuzzing.targets import target_named

MOST_MEMORY = 3_000_000  # kB resident that one input may add; a process that has grown so much ends itself


def main() -> None:
    """Read inputs until ended."""
    name, seed, first, step, folder = sys.argv[1:]
    faulthandler.enable()
    faulthandler.register(signal.SIGUSR1, all_threads=True)  # sent before a hanging process is ended
    warnings.simplefilter("ignore")
    target, place = target_named(name), Path(folder)
    told = sys.stdout
    sys.stdout = sys.stderr
    for each in target.seeds():  # loads and compiles all that is needed
        with _folder(place, target) as inside:
            judged(target, put(each, inside))
    _tell(told, ready=True)
    for index in itertools.count(int(first), int(step)):
        made = target.input(int(seed), index)
        before = _memory()
        if before > MOST_MEMORY:  # what many inputs have left in it
            _tell(told, renewed=True)
            return
        _tell(told, at=index)
        with _folder(place, target) as inside:
            try:
                became = judged(target, put(made, inside))
                added = _memory() - before
                if added > MOST_MEMORY:
                    _tell(told, failed=f"{added / 1e6:.1f} GB of memory", where="memory", trace="")
                    return
                _tell(told, became=became)
            except Exception as error:
                _tell(told, failed=repr(error)[:300], where=_where(error), trace=traceback.format_exc())


class _folder:
    """An empty folder with what a target needs beside its input."""

    def __init__(self, place: Path, target) -> None:
        self.place, self.target = place, target

    def __enter__(self) -> Path:
        self.place.mkdir(parents=True)
        self.target.prepare(self.place)
        return self.place

    def __exit__(self, *_: object) -> None:
        shutil.rmtree(self.place, ignore_errors=True)


def _memory() -> int:
    """The most that has been resident so far, in kB."""
    return resource.getrusage(resource.RUSAGE_SELF).ru_maxrss


def _where(error: BaseException) -> str:
    """Kind of an error and the last line of the project that it came through: equal for equal failures."""
    frames = traceback.extract_tb(error.__traceback__)
    ours = [frame for frame in frames if "hydrolek_drake" in frame.filename] or frames
    return f"{type(error).__name__} in {Path(ours[-1].filename).name}:{ours[-1].lineno}"


def _tell(stream, **what: object) -> None:
    stream.write(json.dumps(what) + "\n")
    stream.flush()


if __name__ == "__main__":
    main()
