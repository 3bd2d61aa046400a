"""`scripts/fuzz`: runs targets for long, tells how far it is, and what failed."""

import argparse
import sys
import time
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

from fuzzing.runner import HANG_S, Outcome, kinds_of_failure, run
from fuzzing.targets import NAMES, TRAP

_TOLD_EVERY = 10.0  # s


def main() -> int:
    """Returns the exit status: 0 if nothing failed."""
    parser = argparse.ArgumentParser(
        prog="scripts/fuzz",
        description="Give damaged inputs to everything that reads what comes from outside. An input must be read, or "
        f"refused in one line that names it: anything else, a crash, or more than {HANG_S:g} s is a failure.",
    )
    many = parser.add_mutually_exclusive_group()
    many.add_argument("--minutes", type=float, help="how long altogether; 10 if there is no --count")
    many.add_argument("--count", type=int, help="how many inputs for each target")
    parser.add_argument(
        "--target", action="append", choices=[*NAMES, TRAP], metavar="NAME", help="one of --list (repeatable)"
    )
    parser.add_argument(
        "--seed", type=int, default=int(time.time()), help="of the inputs; a new one by default"
    )
    parser.add_argument("--first", type=int, default=0, help="number of the first input")
    parser.add_argument("--workers", type=int, default=1, help="targets at a time")
    parser.add_argument("--out", type=Path, default=Path("out/fuzz"), help="folder for inputs that failed")
    parser.add_argument("--list", action="store_true", help="list the targets")
    arguments = parser.parse_args()
    if arguments.list:
        print("\n".join(NAMES))
        return 0
    names = arguments.target or list(NAMES)
    if (arguments.count or 1) < 1 or arguments.workers < 1 or arguments.first < 0 or arguments.seed < 0:
        parser.error("--count and --workers begin at 1, --first and --seed at 0")
    minutes = arguments.minutes or 10.0
    seconds = None if arguments.count else 60.0 * minutes * min(arguments.workers, len(names)) / len(names)
    print(f"seed {arguments.seed}", flush=True)
    told_at: dict[str, float] = {}

    def tell(outcome: Outcome) -> None:
        if time.monotonic() - told_at.setdefault(outcome.name, time.monotonic()) > _TOLD_EVERY:
            told_at[outcome.name] = time.monotonic()
            of = f" of {arguments.count}" if arguments.count else ""
            print(
                f"{outcome.name}: {outcome.inputs}{of}, {len(outcome.failures)} failures",
                file=sys.stderr,
                flush=True,
            )

    def one(name: str) -> Outcome:
        return run(
            name,
            arguments.seed,
            count=arguments.count,
            seconds=seconds,
            first=arguments.first,
            kept_in=arguments.out,
            tell=tell,
        )

    failed = 0
    with ThreadPoolExecutor(arguments.workers) as pool:
        for outcome in pool.map(one, names):
            print(outcome.line(), flush=True)
            for line in kinds_of_failure(outcome, arguments.out):
                print(f"  {line}", flush=True)
            failed += len(outcome.failures)
    return 1 if failed else 0


if __name__ == "__main__":
    sys.exit(main())
