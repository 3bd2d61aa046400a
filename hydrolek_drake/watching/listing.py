"""Which recordings a watch is given."""

from collections.abc import Sequence
from pathlib import Path

from hydrolek_drake.errors import InputError


def listed(given: Sequence[Path], reference: Sequence[Path]) -> list[Path]:
    """Recordings: files as given, and what stands in folders, but for the reference and hidden files.

    A folder that holds `metadata.yaml` is one recording, a ROS 2 bag.

    Raises:
        InputError: there is nothing of that name.
    """
    own = {path.absolute() for path in reference}
    found: list[Path] = []
    for path in given:
        if not path.exists():
            raise InputError(f"--recordings {path}: no such file or folder")
        if path.is_dir() and not (path / "metadata.yaml").exists():
            inside = [p for p in sorted(path.iterdir()) if not p.name.startswith(".")]
            found += [p for p in inside if p.is_file() or (p / "metadata.yaml").exists()]
        else:
            found.append(path)
    return [path for path in dict.fromkeys(found) if path.absolute() not in own]
