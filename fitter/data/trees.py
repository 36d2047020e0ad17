"""NPZ, MATLAB ``.mat`` and JSON files as trees: mappings, lists and arrays, whatever the format calls them."""

import json
import zipfile
import zlib
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np
import scipy.io
from numpy.typing import NDArray
from scipy.io.matlab import MatReadError

from limbcal.errors import DataError

#: What the readers of damaged files are seen to raise.
_DAMAGE = (
    OSError,
    ValueError,
    TypeError,
    LookupError,
    EOFError,
    ArithmeticError,
    MemoryError,
    RecursionError,
    zipfile.BadZipFile,
    zlib.error,
    MatReadError,
)

Array = NDArray[np.generic]
#: A struct or object is a mapping, a cell array or list of anything but numbers a list.
Node = Mapping[str, "Node"] | list["Node"] | Array


def load_tree(path: Path) -> Node:
    """Read a whole file.

    Parameters
    ----------
    path : Path
        ``.npz``, ``.mat`` (up to version 7) or ``.json``. Nothing in it is unpickled.

    Returns
    -------
    mapping or list
        Single values are arrays without dimensions.

    Raises
    ------
    DataError
        If the file is missing or cannot be read as what its suffix says.
    """
    if not path.exists():
        raise DataError(f"{path}: there is no such file")
    kind = path.suffix.lower()
    load = {".npz": _load_npz, ".mat": _load_mat, ".json": _load_json}[kind]
    try:
        return load(path)
    except NotImplementedError as error:
        raise DataError(f"{path}: a MATLAB 7.3 file, expected one saved with '-v7' or older") from error
    except _DAMAGE as error:
        raise DataError(f"{path}: cannot be read as {kind} ({' '.join(str(error).split())})") from error


def _load_npz(path: Path) -> Node:
    with path.open("rb") as file:
        archive = np.load(file, allow_pickle=False)
        if not isinstance(archive, np.lib.npyio.NpzFile):
            raise ValueError("it holds one bare array, expected one a name")
        return {name: archive[name] for name in archive.files}


def _load_mat(path: Path) -> Node:
    content = scipy.io.loadmat(str(path))
    return {name: _from_mat(value) for name, value in content.items() if not name.startswith("__")}


def _from_mat(value: NDArray[Any]) -> Node:
    """Turn cells into lists and structs into mappings, whatever the shape they are stored in."""
    if value.dtype.names:
        fields = {name: value[name].ravel(order="F") for name in value.dtype.names}
        records: list[Node] = [
            {name: _from_mat(np.asarray(cells[k])) for name, cells in fields.items()} for k in range(value.size)
        ]
        return records[0] if len(records) == 1 else records
    if value.dtype == object:
        return [_from_mat(np.asarray(cell)) for cell in value.ravel(order="F")]
    return value.reshape(()) if value.size == 1 else value


def _load_json(path: Path) -> Node:
    root = _from_json(json.loads(path.read_text(encoding="utf-8")))
    if isinstance(root, np.ndarray):
        raise ValueError("it holds a bare list, expected names")
    return root


def _from_json(value: object) -> Node:
    if isinstance(value, dict):
        return {str(name): _from_json(inner) for name, inner in value.items()}
    if isinstance(value, list):
        nodes = [_from_json(inner) for inner in value]
        rows = [node for node in nodes if isinstance(node, np.ndarray)]
        if len(rows) == len(nodes) and len({row.shape for row in rows}) == 1:
            return np.array(value)
        return nodes
    return np.array(value)
