"""Joint motion through every format and back."""

import tempfile
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from hypothesis.extra import numpy as arrays

from fitter.data.motion_file import write_motion
from fitter.data.motions import read_motions
from limbcal.errors import ConfigError, DataError, DeviceError
from protocol.tables.columns import parse_mapping

finite = st.floats(allow_nan=False, allow_infinity=False)


@st.composite
def motions(draw):
    """Columns of any finite numbers, for 1 to 3 joints, on a rising clock."""
    n, n_joint = draw(st.integers(1, 20)), draw(st.integers(1, 3))
    table = arrays.arrays(np.float64, (n, n_joint), elements=finite)
    columns = {role: draw(table) for role in ("q", *draw(st.sets(st.sampled_from(["dq", "ddq", "tau", "ref"]))))}
    if draw(st.booleans()):
        columns["tip"] = draw(arrays.arrays(np.float64, (n, 3), elements=finite))
    start = draw(st.floats(-1e6, 1e6))
    return {"t": start + np.arange(n) * draw(st.floats(1e-4, 1.0)), **columns}


@given(motions(), st.sampled_from([".csv", ".parquet", ".npz"]))
@settings(deadline=None)
def test_what_is_written_is_read_back_bit_for_bit(columns, suffix):
    n_joint = columns["q"].shape[1]
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / f"motion{suffix}"
        write_motion(path, columns)
        (motion,) = read_motions(path, n_joint, parse_mapping(None, n_joint), None, ("q",))
        assert [file.name for file in Path(folder).iterdir()] == [path.name]
    assert np.array_equal(motion.t, columns.pop("t"))
    assert set(motion.columns) == set(columns)
    for role, values in columns.items():
        assert np.array_equal(motion.columns[role], values)


@pytest.mark.parametrize("suffix", [".csv", ".parquet", ".npz"])
@pytest.mark.parametrize("labels", [np.array([1, 1, 2, 2]), np.array(["a", "a", "2.b", "2.b"])])
def test_trials_come_back_apart(tmp_path, suffix, labels):
    path = tmp_path / "new" / f"motion{suffix}"
    write_motion(path, {"t": np.array([0.0, 1.0, 0.0, 1.0]), "q": np.arange(4.0)[:, None], "trial": labels})
    first, second = read_motions(path, 1, parse_mapping(None, 1), None, ("q",))
    assert second.name == f"motion/{labels[2]}"
    assert second.columns["q"][:, 0].tolist() == [2.0, 3.0]


def test_a_file_that_is_there_is_replaced(tmp_path):
    path = tmp_path / "motion.csv"
    path.write_text("old")
    write_motion(path, {"t": np.zeros(1), "q": np.ones((1, 2))})
    assert path.read_text() == "t,q1,q2\n0,1,1\n"


def test_what_cannot_be_written(tmp_path):
    with pytest.raises(ConfigError, match=r"suffix is '\.txt'"):
        write_motion(tmp_path / "motion.txt", {"t": np.zeros(1)})
    with pytest.raises(DataError, match="t 2, q1 3"):
        write_motion(tmp_path / "motion.csv", {"t": np.zeros(2), "q": np.zeros((3, 1))})
    with pytest.raises(DataError, match="shape"):
        write_motion(tmp_path / "motion.csv", {"t": np.zeros((2, 2, 2))})
    with pytest.raises(DataError, match="cannot be written"):
        write_motion(tmp_path / "motion.csv", {"trial": np.array(["a,b"])})
    (tmp_path / "file").touch()
    with pytest.raises(DeviceError, match="cannot be written"):
        write_motion(tmp_path / "file" / "motion.csv", {"t": np.zeros(1)})
    assert [file.name for file in tmp_path.iterdir()] == ["file"]
