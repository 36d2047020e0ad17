"""What unpacks to thousands of times its size is refused before it is unpacked, by what is asked for."""

import io
import resource
import struct
import zipfile
from pathlib import Path

import numpy as np
import pyarrow as pa
import pyarrow.parquet
import pytest
import scipy.io

import playback.__main__
from limbcal.errors import DataError
from protocol.tables import expansion
from protocol.tables.columns import parse_mapping
from protocol.tables.reader import read_tables

ROWS = 2_000_000
ALWAYS_BYTES = expansion.ALWAYS_BYTES  # as it is before a test makes it smaller


@pytest.fixture(autouse=True)
def small_bound(monkeypatch: pytest.MonkeyPatch) -> None:
    """Let a bomb of 16 MB a column do."""
    monkeypatch.setattr(expansion, "ALWAYS_BYTES", 10**7)


def bomb(path: Path, rows: int = ROWS, unused: int = 0) -> Path:
    """Write a motion of one joint that never moves, and beside it a column that nobody asks for."""
    columns = {"t": np.zeros(rows), "q1": np.zeros(rows)}
    if unused:
        columns["unused"] = np.zeros(unused)
    if path.suffix == ".npz":
        np.savez_compressed(path, **columns)
    elif path.suffix == ".mat":
        scipy.io.savemat(path, columns, do_compression=True)
    else:
        pyarrow.parquet.write_table(pa.table(columns), path)
    return path


@pytest.mark.parametrize("suffix", [".npz", ".parquet", ".mat"])
def test_a_bomb_is_refused_before_it_is_unpacked(tmp_path: Path, suffix: str) -> None:
    path = bomb(tmp_path / f"bomb{suffix}")
    before = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
    with pytest.raises(DataError, match=r"would grow from [\d.e-]+ MB to \d+ MB, expected at most 50 times"):
        read_tables(path, 1, parse_mapping(None, 1), ("q",))
    assert resource.getrusage(resource.RUSAGE_SELF).ru_maxrss - before < 20 * 1024


@pytest.mark.parametrize("suffix", [".npz", ".parquet"])
def test_only_what_is_asked_for_counts(tmp_path: Path, suffix: str) -> None:
    rows = 1000 if suffix == ".npz" else 500_000
    path = bomb(tmp_path / f"bomb{suffix}", rows, ROWS if suffix == ".npz" else rows)
    (table,) = read_tables(path, 1, parse_mapping(None, 1), ("q",))
    assert len(table.groups["q"]) == rows


def test_measured_data_may_be_as_large_as_its_file(tmp_path: Path) -> None:
    rng = np.random.default_rng(1)
    np.savez_compressed(tmp_path / "x.npz", t=np.arange(ROWS) * 1e-3, q1=rng.standard_normal(ROWS))
    (table,) = read_tables(tmp_path / "x.npz", 1, parse_mapping(None, 1), ("q",))
    assert len(table.groups["q"]) == ROWS


def test_export_says_it_in_a_sentence(tmp_path: Path, capfd: pytest.CaptureFixture[str]) -> None:
    path = bomb(tmp_path / "bomb.npz")
    code = playback.__main__.main(["export", str(path), "--arm", "dd-arm", "--out", str(tmp_path / "x.csv")])
    said = capfd.readouterr().err
    assert code == 2 and "Traceback" not in said and not (tmp_path / "x.csv").exists()


def test_a_header_without_end_is_refused(tmp_path: Path) -> None:
    """Version 2 of the format has 32 bits for the header's length: it is zeros, and packs to nothing."""
    header = b"\x93NUMPY\x02\x00" + struct.pack("<I", 10**8) + bytes(10**8)
    with zipfile.ZipFile(tmp_path / "x.npz", "w", zipfile.ZIP_DEFLATED) as archive:
        for name in ("t", "q1"):
            archive.writestr(f"{name}.npy", header)
    with pytest.raises(DataError, match="would grow|header has 100000000 bytes, expected at most 10000"):
        read_tables(tmp_path / "x.npz", 1, parse_mapping(None, 1), ("q",))


def test_a_length_that_lies_is_no_traceback(tmp_path: Path) -> None:
    buffer = io.BytesIO()
    np.lib.format.write_array_header_1_0(buffer, {"descr": "<f8", "fortran_order": False, "shape": (10**14,)})
    with zipfile.ZipFile(tmp_path / "x.npz", "w") as archive:
        for name in ("t", "q1"):
            archive.writestr(f"{name}.npy", buffer.getvalue())
    with pytest.raises(DataError, match="cannot be read as NPZ"):
        read_tables(tmp_path / "x.npz", 1, parse_mapping(None, 1), ("q",))


@pytest.mark.parametrize(
    ("always", "size", "asked", "fits"),
    [(100, 1, 100, True), (100, 1, 101, False), (100, 10, 500, True), (100, 10, 501, False)],
)
def test_fifty_times_a_file_s_size_or_what_any_may_become(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, always: int, size: int, asked: int, fits: bool
) -> None:
    monkeypatch.setattr(expansion, "ALWAYS_BYTES", always)
    path = tmp_path / "x"
    path.write_bytes(bytes(size))
    if fits:
        expansion.require_modest(path, asked, "it")
    else:
        with pytest.raises(DataError, match="it would grow from .* MB, expected at most 50 times as much or 0 MB"):
            expansion.require_modest(path, asked, "it")
    assert ALWAYS_BYTES == 536_870_912


def test_the_sentence_is_in_megabytes(tmp_path: Path) -> None:
    path = tmp_path / "x"
    path.write_bytes(bytes(20_000))
    with pytest.raises(DataError, match=r"it would grow from 0\.02 MB to 1\.23e\+03 MB, .* or 10 MB"):
        expansion.require_modest(path, 1_234_000_000, "it")
