"""Files read some rows at a time: the same rows as whole."""

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from fitter.data.blocks import read_blocks
from fitter.data.motion_file import write_motion
from fitter.data.motions import read_file
from fitter.data.stretches import joined
from limbcal.errors import DataError
from protocol.tables.columns import parse_mapping

N = 5000


@pytest.fixture(scope="module")
def columns():
    rng = np.random.default_rng(0)
    trial = np.repeat(["a", "b"], [2000, 3000])
    return {"t": np.arange(N) * 1e-3, "q": rng.normal(size=(N, 2)), "tau": rng.normal(size=(N, 2)), "trial": trial}


def blocks(path, rows=700, mapping=None, rate_hz=None):
    return list(read_blocks(path, 2, parse_mapping(mapping, 2), rate_hz, rows))


@pytest.mark.parametrize("suffix", [".csv", ".parquet", ".npz"])
def test_blocks_side_by_side_are_the_file(tmp_path, columns, suffix):
    path = tmp_path / f"run{suffix}"
    write_motion(path, columns)
    found = blocks(path)
    whole = read_file(path, 2, parse_mapping(None, 2), None, ("q",), {})[0]
    together = joined(found)
    assert np.array_equal(together.t, whole.t)
    assert together.labels.tolist() == whole.labels.tolist()
    assert {name: values.tolist() for name, values in together.columns.items()} == {
        name: values.tolist() for name, values in whole.columns.items()
    }
    assert [block.first_row for block in found] == np.cumsum([0, *(len(b.t) for b in found[:-1])]).tolist()
    if suffix != ".csv":  # CSV comes in blocks of bytes
        assert max(len(block.t) for block in found) == 700


def test_a_csv_of_several_megabytes_comes_in_blocks(tmp_path):
    rng = np.random.default_rng(0)
    write_motion(tmp_path / "long.csv", {"t": np.arange(40_000) * 1e-3, "q": rng.normal(size=(40_000, 2))})
    found = blocks(tmp_path / "long.csv")
    assert len(found) > 1
    assert sum(len(block.t) for block in found) == 40_000


def test_stamps_go_on_from_block_to_block_where_only_a_rate_is_known(tmp_path, columns):
    write_motion(tmp_path / "run.npz", {"q": columns["q"]})
    assert np.allclose(joined(blocks(tmp_path / "run.npz", rate_hz=1000.0)).t, columns["t"])
    with pytest.raises(DataError, match="no column 't'"):
        blocks(tmp_path / "run.npz")


@pytest.mark.parametrize("suffix", [".csv", ".parquet", ".npz"])
def test_a_bad_value_is_named_by_column_and_row(tmp_path, columns, suffix):
    q = columns["q"].copy()
    q[3210, 1] = np.nan
    write_motion(tmp_path / f"run{suffix}", columns | {"q": q})
    with pytest.raises(DataError, match=r"q2'?, row 3211: found nothing or NaN"):
        blocks(tmp_path / f"run{suffix}")


def test_a_table_within_an_npz_is_read_whole(tmp_path, columns):
    np.savez(tmp_path / "run.npz", t=columns["t"], pos=columns["q"].T)
    found = blocks(tmp_path / "run.npz", mapping="q=pos[{j}]")
    assert len(found) == 1
    assert np.array_equal(found[0].columns["q"], columns["q"])


def test_a_file_that_ends_early_is_said(tmp_path, columns):
    np.savez(tmp_path / "run.npz", t=columns["t"], q1=columns["q"][:, 0], q2=columns["q"][:, 1])
    whole = (tmp_path / "run.npz").read_bytes()
    (tmp_path / "run.npz").write_bytes(whole[: len(whole) // 2])
    with pytest.raises(DataError, match="cannot be read as NPZ"):
        blocks(tmp_path / "run.npz")


@settings(max_examples=60, deadline=None, suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(place=st.floats(0.0, 1.0, exclude_max=True), flip=st.integers(1, 255))
def test_a_damaged_npz_is_said_or_read_as_it_was(tmp_path, place, flip):
    write_motion(tmp_path / "run.npz", {"t": np.arange(20.0), "q": np.ones((20, 2))})
    damaged = bytearray((tmp_path / "run.npz").read_bytes())
    damaged[int(place * len(damaged))] ^= flip
    (tmp_path / "run.npz").write_bytes(damaged)
    try:
        assert joined(blocks(tmp_path / "run.npz", rows=7)).columns["q"].tolist() == np.ones((20, 2)).tolist()
    except DataError as error:
        assert "run.npz" in str(error)


@pytest.mark.parametrize("name", ["none.csv", "none.parquet", "none.npz"])
def test_a_missing_file_is_said(tmp_path, name):
    with pytest.raises(DataError, match="no such file"):
        blocks(tmp_path / name)


def test_a_header_alone_is_no_data(tmp_path):
    (tmp_path / "run.csv").write_text("t,q1,q2\n")
    with pytest.raises(DataError, match="no row"):
        blocks(tmp_path / "run.csv")
