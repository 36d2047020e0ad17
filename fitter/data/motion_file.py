"""Writing joint motion: CSV, Parquet or NPZ, whichever the suffix says."""

import os
from collections.abc import Mapping
from contextlib import suppress
from pathlib import Path

import numpy as np
import pyarrow as pa
import pyarrow.csv
import pyarrow.parquet
from numpy.typing import NDArray

from limbcal.errors import ConfigError, DataError, DeviceError

Column = NDArray[np.generic]

TIP_AXES = "xyz"


def write_motion(path: Path, columns: Mapping[str, Column]) -> None:
    """Write joint motion that every command reads back without a mapping, bit for bit.

    Parameters
    ----------
    path : Path
        ``.csv``, ``.parquet`` or ``.npz``. A file that is there is replaced, in one step, once all is written.
    columns : mapping of str to ndarray
        ``t`` and, where there are several trials, ``trial`` of shape (n,); ``q``, ``dq``, ``ddq``, ``tau``,
        ``ref`` and ``q_std`` of shape (n, n_joint), written as ``q1 … qn``; ``tip`` of shape (n, 3), written as
        ``tipx tipy tipz``. Any other 1-D column goes by its own name.

    Raises
    ------
    ConfigError
        If the suffix is another.
    DataError
        If the columns differ in length or have more than two dimensions.
    DeviceError
        If the disk fails.
    """
    suffix = path.suffix.lower()
    if suffix not in (".csv", ".parquet", ".npz"):
        raise ConfigError(f"{path}: the suffix is {path.suffix!r}, expected .csv, .parquet or .npz")
    flat = _flatten(path, columns)
    part = path.with_name(f".{path.name}.part{suffix}")
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        with part.open("wb") as file:
            if suffix == ".npz":
                np.savez_compressed(file, allow_pickle=False, **flat)
            elif suffix == ".csv":
                pyarrow.csv.write_csv(
                    pa.table(flat), file, pyarrow.csv.WriteOptions(quoting_style="none", quoting_header="none")
                )
            else:
                pyarrow.parquet.write_table(pa.table(flat), file)
        os.replace(part, path)
    except pa.ArrowInvalid as error:
        raise DataError(f"{path}: cannot be written ({' '.join(str(error).split())})") from error
    except OSError as error:
        raise DeviceError(f"{path}: cannot be written ({error.strerror or error})") from error
    finally:
        with suppress(OSError):
            part.unlink(missing_ok=True)


def _flatten(path: Path, columns: Mapping[str, Column]) -> dict[str, Column]:
    """Give every column of a table a name of its own."""
    flat: dict[str, Column] = {}
    for name, values in columns.items():
        if values.ndim == 1:
            flat[name] = values
        elif values.ndim == 2:
            ends = TIP_AXES if name == "tip" else [str(k + 1) for k in range(values.shape[1])]
            flat |= {f"{name}{end}": values[:, k] for k, end in enumerate(ends)}
        else:
            raise DataError(f"{path}: column {name!r} has shape {values.shape}, expected (n,) or (n, k)")
    lengths = {name: len(values) for name, values in flat.items()}
    if len(set(lengths.values())) > 1:
        said = ", ".join(f"{name} {length}" for name, length in lengths.items())
        raise DataError(f"{path}: the columns to be written have lengths {said}, expected one length")
    return flat
