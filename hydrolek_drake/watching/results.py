"""What a watch leaves in its folder: table and page."""

from collections.abc import Sequence
from pathlib import Path

from hydrolek_drake.files import write_results
from hydrolek_drake.watching.limits import Limit
from hydrolek_drake.watching.page import page
from hydrolek_drake.watching.table import as_parquet
from hydrolek_drake.watching.watch import Watched


def write_watch(watched: Watched, folder: Path, limits: Sequence[Limit] = ()) -> list[Path]:
    """Write `watch.parquet` and `watch.html`, each when complete.

    Args:
        watched: the outcome.
        folder: where; made if it is missing.
        limits: that the user set.

    Raises:
        InputError: the folder cannot be written to.
    """
    contents: dict[str, bytes | str] = {
        "watch.parquet": as_parquet([*watched.reference, *watched.seen], watched.evidence),
        "watch.html": page(watched, limits, folder),
    }
    return write_results(folder, contents)
