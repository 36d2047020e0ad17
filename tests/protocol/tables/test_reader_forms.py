"""Tables as Parquet, JSON and Matlab have them, and stamps that are dates or count from 1970."""

import json

import numpy as np
import pyarrow as pa
import pyarrow.parquet
import pytest
import scipy.io

from limbcal.errors import DataError
from tests.protocol.tables.written_tables import N, Q, T, read, text_of, written

START_NS = 1_700_000_000_123_456_789


STAMPS_NS = START_NS + 10_000_000 * np.arange(N)


ISO = np.datetime_as_string(STAMPS_NS.astype("datetime64[ns]"))


def parquet(path, columns):
    pyarrow.parquet.write_table(pa.table(columns), path)


@pytest.mark.parametrize(
    "stamps",
    [
        pa.array(STAMPS_NS),
        pa.array(STAMPS_NS.astype("datetime64[ns]")),
        pa.array(STAMPS_NS.astype("datetime64[ns]"), pa.timestamp("ns", "Europe/Berlin")),
        pa.array((STAMPS_NS // 1000).astype("datetime64[us]")),
        pa.array(STAMPS_NS // 1000),
        pa.array((STAMPS_NS - START_NS).astype("timedelta64[ns]")),
    ],
    ids=lambda stamps: str(stamps.type),
)
def test_whole_numbers_and_stamps_of_parquet_keep_their_digits(tmp_path, stamps):
    path = tmp_path / "run.parquet"
    parquet(path, {"t": stamps, "q1": np.round(Q[:, 0]).astype(np.int64), "q2": Q[:, 1], "id": [2**60 + 1] * N})
    table = read(path)
    assert np.allclose(table.groups["t"][:, 0], T, atol=1e-12, rtol=0)
    assert table.stated >= {"t"}


@pytest.mark.parametrize("ending", ["", "Z", "+02:00"])
@pytest.mark.parametrize("between", ["T", " "])
def test_dates_and_times_as_text(tmp_path, ending, between):
    stamps = [stamp.replace("T", between) + ending for stamp in ISO]
    rows = [f"{stamp},{a!r},{b!r}" for stamp, (a, b) in zip(stamps, Q.tolist(), strict=True)]
    table = read(written(tmp_path, "\n".join(["t,q1,q2", *rows, ""])))
    assert np.allclose(table.groups["t"][:, 0], T, atol=1e-12, rtol=0)
    records = [{"t": stamp, "q1": a, "q2": b} for stamp, (a, b) in zip(stamps, Q.tolist(), strict=True)]
    table = read(written(tmp_path, json.dumps(records), "run.json"))
    assert np.allclose(table.groups["t"][:, 0], T, atol=1e-12, rtol=0)


def test_nanoseconds_as_text_and_in_npz(tmp_path):
    rows = [f"{stamp},{a!r},{b!r}" for stamp, (a, b) in zip(STAMPS_NS.tolist(), Q.tolist(), strict=True)]
    for header in ("t,q1,q2", "t_ns,q1,q2"):
        table = read(written(tmp_path, "\n".join([header, *rows, ""])))
        assert np.allclose(table.groups["t"][:, 0], T, atol=1e-12, rtol=0)
        assert table.origin_s == pytest.approx(START_NS * 1e-9)
    for stamps in (STAMPS_NS, STAMPS_NS.astype("datetime64[ns]")):
        np.savez(tmp_path / "run.npz", t=stamps, q1=Q[:, 0], q2=Q[:, 1], other=np.array([{}], dtype=object))
        assert np.allclose(read(tmp_path / "run.npz").groups["t"][:, 0], T, atol=1e-12, rtol=0)


def test_short_counts_keep_their_own_zero(tmp_path):
    rows = [f"{5_000_000_000 + 10_000_000 * k},0,0" for k in range(N)]
    table = read(written(tmp_path, "\n".join(["t [ns],q1,q2", *rows, ""])))
    assert np.allclose(table.groups["t"][:, 0], 5.0 + T) and table.origin_s == 0.0


JSON = {
    "columns": {"t": T.tolist(), "q1": Q[:, 0].tolist(), "q2": Q[:, 1].tolist(), "note": "hm"},
    "records": [{"t": t, "q1": a, "q2": b} for t, (a, b) in zip(T.tolist(), Q.tolist(), strict=True)],
    "pandas, split": {
        "columns": ["t", "q1", "q2"],
        "index": list(range(N)),
        "data": np.column_stack([T, Q]).tolist(),
    },
    "pandas": {
        name: {str(k): value for k, value in enumerate(values)}
        for name, values in (("t", T.tolist()), ("q1", Q[:, 0].tolist()), ("q2", Q[:, 1].tolist()))
    },
}


@pytest.mark.parametrize("way", JSON)
def test_json_tables(tmp_path, way):
    table = read(written(tmp_path, json.dumps(JSON[way]), "run.json"))
    assert np.allclose(table.groups["q"], Q) and np.allclose(table.groups["t"][:, 0], T)


@pytest.mark.parametrize("name", ["run.jsonl", "run.ndjson", "run.json"])
def test_json_lines_and_a_last_one_that_is_cut(tmp_path, name):
    lines = "\n".join(map(json.dumps, JSON["records"]))
    assert np.allclose(read(written(tmp_path, lines, name)).groups["q"], Q)
    table = read(written(tmp_path, lines[:-7], name))
    assert np.allclose(table.groups["q"], Q[:-1]) and table.notes[0].kind == "cut"
    with pytest.raises(DataError, match="line 3: "):
        read(written(tmp_path, lines.replace('"q1"', '"q1', 3).replace('"q1', '"q1"', 2) + "\n", name))


def test_matlab(tmp_path):
    scipy.io.savemat(
        tmp_path / "run.mat", {"t": T[:, None], "q1_deg": np.degrees(Q[:, 0]), "q2_deg": np.degrees(Q[:, 1])}
    )
    table = read(tmp_path / "run.mat")
    assert np.allclose(table.groups["q"], Q) and table.stated == {"q1", "q2"}
    for head in (b"MATLAB 7.3 MAT-file".ljust(512), b""):
        with pytest.raises(
            DataError, match=r"a MATLAB 7.3 file, expected one saved in MATLAB with save\(…, '-v7'\)"
        ):
            read(written(tmp_path, head + b"\x89HDF\r\n\x1a\n" + b"\0" * 64, "new.mat"))


def test_trials_are_text_whatever_they_are(tmp_path):
    content = text_of("t,q1,q2,trial", trail=",Über ärger").encode("cp1252")
    assert set(read(written(tmp_path, content)).labels) == {"Über ärger"}


@pytest.mark.parametrize("content", [np.random.default_rng(0).bytes(1000), b"\0" * 100, b"", b"\n\n", b"# t\n"])
def test_no_text_at_all(tmp_path, content):
    with pytest.raises(DataError, match=r"run\.csv: "):
        read(written(tmp_path, content))
