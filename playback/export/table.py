"""A sampled motion as CSV that every command reads back."""

from pathlib import Path

import pyarrow as pa
import pyarrow.csv

from playback.export.sampled import Mover, Sampled
from playback.export.whole_file import whole_file
from playback.trajectory import Floats


def write_table(path: Path, motion: Sampled) -> None:
    """Write one row a frame: t, q1…, dq1…, ddq1…, tipx tipy tipz, and point1x… for every sensor.

    The columns of a twin have the same names after ``twin_``. Numbers are read back bit for bit.

    Raises
    ------
    DeviceError
        If the disk fails.
    """
    columns: dict[str, Floats] = {"t": motion.t}
    for mover, prefix in zip(motion.movers, ("", "twin_"), strict=False):
        columns |= {prefix + name: values for name, values in _columns(mover).items()}
    options = pyarrow.csv.WriteOptions(quoting_style="none", quoting_header="none")
    with whole_file(path) as part, part.open("wb") as file:
        pyarrow.csv.write_csv(pa.table(columns), file, options)


def _columns(mover: Mover) -> dict[str, Floats]:
    joints = {
        f"{name}{j + 1}": values[:, j]
        for name, values in (("q", mover.q), ("dq", mover.dq), ("ddq", mover.ddq))
        for j in range(values.shape[1])
    }
    tip = {f"tip{axis}": mover.tip[:, k] for k, axis in enumerate("xyz")}
    points = {
        f"point{s + 1}{axis}": mover.points[:, s, k]
        for s in range(mover.points.shape[1])
        for k, axis in enumerate("xyz")
    }
    return {**joints, **tip, **points}
