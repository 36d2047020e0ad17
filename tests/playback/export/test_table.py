"""CSV that our own readers, and so every command, read back."""

from pathlib import Path

import numpy as np
import pyarrow.csv

from playback.export.sampled import Sampled
from playback.export.table import write_table
from playback.file_source import file_source


def read_columns(path: Path) -> dict[str, np.ndarray]:
    table = pyarrow.csv.read_csv(path)
    return {name: table.column(name).to_numpy() for name in table.column_names}


def test_it_is_read_back_bit_for_bit(tmp_path: Path, motion: Sampled) -> None:
    path, mover = tmp_path / "motion.csv", motion.movers[0]
    write_table(path, motion)
    columns = read_columns(path)
    assert np.array_equal(columns["t"], motion.t)
    for name in ("q", "dq", "ddq"):
        joints = [columns[f"{name}{j + 1}"] for j in range(mover.arm.n_joint)]
        assert np.array_equal(np.column_stack(joints), getattr(mover, name))
    assert np.array_equal(np.column_stack([columns[f"tip{axis}"] for axis in "xyz"]), mover.tip)
    for s in range(len(mover.arm.sensors)):
        point = np.column_stack([columns[f"point{s + 1}{axis}"] for axis in "xyz"])
        assert np.array_equal(point, mover.points[:, s])
    replayed = file_source(path, mover.arm).load()
    assert np.array_equal(replayed.q, mover.q) and np.array_equal(replayed.ddq, mover.ddq)


def test_a_twin_has_columns_of_its_own(tmp_path: Path, pair: Sampled) -> None:
    path = tmp_path / "pair.csv"
    write_table(path, pair)
    columns = read_columns(path)
    assert np.array_equal(columns["q2"], pair.movers[0].q[:, 1])
    assert np.array_equal(columns["twin_q2"], pair.movers[1].q[:, 1])
    assert np.array_equal(columns["twin_tipy"], pair.movers[1].tip[:, 1])
    assert [path.name for path in tmp_path.iterdir()] == ["pair.csv"]
