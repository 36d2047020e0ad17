"""Columns out of the three formats."""

from pathlib import Path

import numpy as np
import pyarrow as pa
import pyarrow.parquet
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays

from limbcal.errors import DataError
from protocol.motion_file import joint_columns, read_columns

finite = st.floats(allow_nan=False, allow_infinity=False, width=64)
tables = st.integers(1, 20).flatmap(
    lambda n: st.fixed_dictionaries({name: arrays(np.float64, n, elements=finite) for name in ("t", "q1", "q2")})
)


def write(path: Path, columns: dict[str, np.ndarray]) -> Path:
    if path.suffix == ".npz":
        np.savez(path, **columns)
    elif path.suffix == ".parquet":
        pyarrow.parquet.write_table(pa.table(columns), path)
    else:
        rows = [
            ",".join(columns),
            *(",".join(map(repr, map(float, row))) for row in zip(*columns.values(), strict=True)),
        ]
        path.write_text("\n".join(rows) + "\n", encoding="utf-8")
    return path


@pytest.mark.parametrize("suffix", [".csv", ".npz", ".parquet"])
@settings(suppress_health_check=[HealthCheck.function_scoped_fixture], max_examples=25, deadline=None)
@given(columns=tables)
def test_every_format_gives_back_what_was_written(
    tmp_path: Path, suffix: str, columns: dict[str, np.ndarray]
) -> None:
    found = read_columns(write(tmp_path / f"motion{suffix}", columns))
    assert list(found) == list(columns)
    for name, column in columns.items():
        np.testing.assert_array_equal(found[name], column)


def test_whole_numbers_become_floats_and_words_and_empty_cells_no_number(tmp_path: Path) -> None:
    path = tmp_path / "motion.csv"
    path.write_text("t,q1,who,empty\n0,1,me,\n1,,2.5,\n", encoding="utf-8")
    found = read_columns(path)
    assert {column.dtype for column in found.values()} == {np.dtype(np.float64)}
    for name, known in {"t": [0, 1], "q1": [1, np.nan], "who": [np.nan, 2.5], "empty": [np.nan] * 2}.items():
        np.testing.assert_array_equal(found[name], known)


def test_joint_columns_come_side_by_side_in_the_order_of_the_joints() -> None:
    columns = {"q2": np.array([3.0, 4.0]), "q1": np.array([1.0, 2.0]), "q4": np.array([9.0, 9.0])}
    np.testing.assert_array_equal(joint_columns(columns, "q"), [[1.0, 3.0], [2.0, 4.0]])
    assert joint_columns(columns, "dq") is None


@pytest.mark.parametrize(
    ("name", "content", "said"),
    [
        ("motion.txt", b"t\n0\n", "suffix is '.txt', expected one of .csv"),
        ("motion", b"t\n0\n", "suffix is ''"),
        ("motion.csv", b"", "cannot be read as CSV"),
        ("motion.csv", b"t,q1\n0,1\n0,1,2\n", "cannot be read as CSV"),
        ("motion.csv", b"t,q1,q1\n0,1,2\n", "'q1' appears twice"),
        ("motion.parquet", b"garbage", "cannot be read as PARQUET"),
        ("motion.npz", b"garbage", "cannot be read as NPZ"),
        ("motion.npz", b"PK\x03\x04garbage", "cannot be read as NPZ"),
    ],
)
def test_what_is_no_such_file_is_refused_in_one_sentence(
    tmp_path: Path, name: str, content: bytes, said: str
) -> None:
    path = tmp_path / name
    path.write_bytes(content)
    with pytest.raises(DataError, match=said) as caught:
        read_columns(path)
    assert str(path) in str(caught.value)
    assert "\n" not in str(caught.value)


def test_a_missing_file_and_odd_archives_are_refused(tmp_path: Path) -> None:
    with pytest.raises(DataError, match="there is no such file"):
        read_columns(tmp_path / "nowhere.csv")
    uneven = tmp_path / "uneven.npz"
    np.savez(uneven, t=np.zeros(3), q1=np.zeros(2))
    with pytest.raises(DataError, match=r"differ in length \(t 3, q1 2\)"):
        read_columns(uneven)
    flat = tmp_path / "flat.npz"
    np.savez(flat, t=np.zeros(3), q=np.zeros((3, 2)))
    with pytest.raises(DataError, match=r"'q' has shape \(3, 2\)"):
        read_columns(flat)
    pickled = tmp_path / "pickled.npz"
    np.savez(pickled, t=np.array([{}], dtype=object))
    with pytest.raises(DataError, match="cannot be read as NPZ"):
        read_columns(pickled)
    bare = tmp_path / "bare.npz"
    with bare.open("wb") as file:
        np.save(file, np.zeros(3))
    with pytest.raises(DataError, match="one bare array"):
        read_columns(bare)
