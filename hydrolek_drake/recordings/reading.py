"""Reading a recording from any file format that is supported."""

from collections.abc import Callable, Mapping
from pathlib import Path

from hydrolek_drake.errors import InputError
from hydrolek_drake.recordings.assembly import assemble
from hydrolek_drake.recordings.columns import check_mapping
from hydrolek_drake.recordings.csv_reader import read_csv
from hydrolek_drake.recordings.mat_reader import read_mat
from hydrolek_drake.recordings.mcap_reader import mcap_of_bag, read_mcap
from hydrolek_drake.recordings.parquet_reader import read_parquet
from hydrolek_drake.recordings.recording import Recording
from hydrolek_drake.recordings.table import Table
from hydrolek_drake.recordings.tdms_reader import read_tdms

_READERS: dict[str, Callable[[Path], Table]] = {
    ".csv": read_csv,
    ".tsv": read_csv,
    ".txt": read_csv,
    ".parquet": read_parquet,
    ".tdms": read_tdms,
    ".mat": read_mat,
    ".mcap": read_mcap,
}
_SIGNATURES = {
    b"PAR1": ".parquet",
    b"TDSm": ".tdms",
    b"MATLAB ": ".mat",
    b"\x89HDF": ".mat",
    b"\x89MCAP": ".mcap",
}


def read_recording(path: str | Path, columns: Mapping[str, str] | None = None) -> Recording:
    """Read a recording from CSV, Parquet, TDMS, MATLAB, MCAP or a ROS 2 bag folder.

    The extension decides the format; where it is not a known one, the first bytes of the file do.

    Args:
        path: File, or folder of a ROS 2 bag.
        columns: Contract name (`time_s`, `<joint>.<quantity>_<unit>`, or `ignore`) by column name in the
            file, from the rig; names that the file does not have are passed over.

    Returns:
        The recording in SI units, with everything noteworthy in its `findings`.

    Raises:
        InputError: The file is missing, unreadable or empty; there is no time column or no signal; a column
            is present twice, has an unknown unit, holds text or nothing at all; time is not finite or runs
            backwards; there are fewer than two rows; or `columns` itself is wrong.
    """
    path = Path(path)
    mapping = columns or {}
    check_mapping(mapping)
    try:
        file = mcap_of_bag(path) if path.is_dir() else path
        table = _reader(file)(file)
    except InputError:
        raise
    except FileNotFoundError:
        raise InputError(f"recording {path} does not exist") from None
    except Exception as error:  # a parser met with bytes that nobody foresaw may raise anything
        reason = " ".join(str(error).split())[:160] or type(error).__name__
        raise InputError(f"{path} cannot be read, it may be damaged or incomplete: {reason}") from None
    return assemble(table, mapping, path)


def _reader(path: Path) -> Callable[[Path], Table]:
    with path.open("rb") as stream:
        head = stream.read(8)
    if not head:
        raise InputError(f"{path} is empty")
    extension = path.suffix.lower()
    if extension not in _READERS:
        extension = next(
            (known for signature, known in _SIGNATURES.items() if head.startswith(signature)), ""
        )
    if not extension:
        raise InputError(
            f"{path} is no recording in a known format; use one of {', '.join(_READERS)} or a ROS 2 bag "
            "folder"
        )
    return _READERS[extension]
