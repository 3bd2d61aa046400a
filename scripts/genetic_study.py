"""The study of thesis sections 4.5 and 4.6: searches compared on the mechanical model.

Tables go to docs/evidence, numbers to its folder data, pictures to docs/pictures/identification.

Run as `python scripts/genetic_study.py [--runs 10] [--seed 1] [--out DIR]`.
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
    parser.add_argument("--out", type=Path, help="folder for all of it; the documentation's if not given")
    chosen = parser.parse_args()
    begun = time.perf_counter()
    found = run_study(chosen.seed, chosen.runs, lambda what: print(what, flush=True))
    seconds = time.perf_counter() - begun
    docs = Path(__file__).parents[1] / "docs"
    folder, pictures = docs / "evidence", docs / "pictures" / "identification"
    data = folder / "data"
    if chosen.out is not None:
        folder = data = chosen.out
        pictures = chosen.out / "pictures"
    today = datetime.date.today().isoformat()
    written = write_study(found, folder, data, pictures, chosen.seed, today, seconds)
    print(as_markdown(found), *written, sep="\n")


if __name__ == "__main__":
    main()
