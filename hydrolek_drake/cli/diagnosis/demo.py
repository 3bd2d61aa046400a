"""`hydrolek demo`: a diagnosis of the recordings that come with the project."""

from pathlib import Path
from typing import Annotated

import typer

import hydrolek_drake
from hydrolek_drake.cli.settings import SeedOption


def demo(
    out: Annotated[Path, typer.Option(metavar="DIR", help="folder for the report")] = Path("out/demo"),
    seed: SeedOption = None,
) -> None:
    """Diagnose a machine whose piston leaks, with a model that knows nothing of it."""
    from hydrolek_drake.cli.diagnosis.diagnose import diagnose

    machine = practice_pair()
    diagnose("joint_bench", [machine / "train.csv"], [machine / "holdout.csv"], out=out, seed=seed)


def practice_pair() -> Path:
    """Folder of the machine's two recordings: in the installed package, or among the tests' data."""
    package = Path(hydrolek_drake.__file__).resolve().parent
    installed = package / "practice" / "practice_04"
    return installed if installed.is_dir() else package.parent / "tests" / "data" / "bench" / "practice_04"
