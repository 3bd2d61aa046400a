"""Reading a recording from any file format that is supported, or from a DataFrame."""

from collections.abc import Callable, Mapping
from pathlib import Path
from typing import TYPE_CHECKING

from hydrolek_drake.errors import InputError
from hydrolek_drake.recordings.assembly import assemble
from hydrolek_drake.recordings.bag_reader import read_bag
from hydrolek_drake.recordings.columns import check_mapping
from hydrolek_drake.recordings.csv_reader import read_csv
from hydrolek_drake.recordings.frame_reader import is_frame, read_frame
from hydrolek_drake.recordings.mat_reader import read_mat
from hydrolek_drake.recordings.mdf_reader import read_mdf
from hydrolek_drake.recordings.parquet_reader import read_parquet
from hydrolek_drake.recordings.recording import Recording
from hydrolek_drake.recordings.table import Table
from hydrolek_drake.recordings.tdms_reader import read_tdms

if TYPE_CHECKING:
    import pandas

_Reader = Callable[[Path, Mapping[str, str]], Table]


def _whole(read: Callable[[Path], Table]) -> _Reader:
    """A reader that reads all columns, whoever asks for which."""
    return lambda path, mapping: read(path)


_READERS: dict[str, _Reader] = {
    ".csv": _whole(read_csv),
    ".tsv": _whole(read_csv),
    ".txt": _whole(read_csv),
    ".parquet": _whole(read_parquet),
    ".tdms": _whole(read_tdms),
    ".mat": read_mat,
    ".mf4": read_mdf,
    ".mdf": read_mdf,
    ".mcap": read_bag,
    ".db3": read_bag,
    ".bag": read_bag,
}
_SIGNATURES = {
    b"PAR1": ".parquet",
    b"TDSm": ".tdms",
    b"MATLAB ": ".mat",
    b"\x89HDF": ".mat",
    b"\x89MCAP": ".mcap",
    b"MDF ": ".mf4",
    b"#ROSBAG": ".bag",
}


def read_recording(
    path: "str | Path | pandas.DataFrame",
    columns: Mapping[str, str] | None = None,
    *,
    dead_time: float = 0.0,
) -> Recording:
    """Read a recording from CSV, Parquet, TDMS, MATLAB, MDF, a ROS bag, or take it from a DataFrame.

    The extension decides the format; where it is not a known one, the first bytes of the file do. Signals that were
    recorded by clocks of their own are put on one (`one_clock`).

    Args:
        path: File, folder of a ROS bag, or DataFrame with a column or an index of times.
        columns: Contract name (`time_s`, `<joint>.<quantity>_<unit>`, or `ignore`) by column name in the
            file, from the rig; names that the file does not have are passed over.
        dead_time: By how much a motion follows its command [s], for clocks whose offset has to be found from the data.

    Returns:
        The recording in SI units, with everything noteworthy in its `findings`.

    Raises:
        InputError: The file is missing, unreadable or empty; there is no time column or no signal; a column
            is present twice, has an unknown unit, holds text or nothing at all; time is not finite or runs
            backwards; there are fewer than two rows; clocks have no time in common; or `columns` itself is wrong.
    """
    mapping = columns or {}
    check_mapping(mapping)
    if is_frame(path):
        name = Path(str(getattr(path, "attrs", {}).get("name") or "DataFrame"))
        return assemble(read_frame(path), mapping, name, dead_time)
    path = Path(path)
    try:
        table = (read_bag if path.is_dir() else _reader(path))(path, mapping)
    except InputError:
        raise
    except FileNotFoundError:
        raise InputError(f"recording {path} does not exist") from None
    except Exception as error:  # a parser met with bytes that nobody foresaw may raise anything
        reason = " ".join(str(error).split())[:160] or type(error).__name__
        raise InputError(f"{path} cannot be read, it may be damaged or incomplete: {reason}") from None
    return assemble(table, mapping, path, dead_time)


def _reader(path: Path) -> _Reader:
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
            f"{path} is no recording in a known format; use one of {', '.join(_READERS)} or a folder "
            "of a ROS bag"
        )
    return _READERS[extension]
