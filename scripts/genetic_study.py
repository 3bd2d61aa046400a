"""The study of thesis sections 4.5 and 4.6: searches compared on the mechanical model; results go to docs/.

Run as `python scripts/genetic_study.py [--runs 10] [--seed 1] [--out docs]`.
"""

import argparse
import datetime
import time
from pathlib import Path

from hydrolek_drake.identification.mechanical.study import run_study
from hydrolek_drake.identification.mechanical.study_report import as_markdown, write_study


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--runs", type=int, default=10, help="searches in each row")
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--out", type=Path, default=Path(__file__).parents[1] / "docs" / "evidence")
    chosen = parser.parse_args()
    begun = time.perf_counter()
    found = run_study(chosen.seed, chosen.runs, lambda what: print(what, flush=True))
    seconds = time.perf_counter() - begun
    written = write_study(found, chosen.out, chosen.seed, datetime.date.today().isoformat(), seconds)
    print(as_markdown(found), *written, sep="\n")


if __name__ == "__main__":
    main()
