"""`fitter markers`: its document, its words, its exit codes."""

import json

import numpy as np

from fitter.__main__ import main
from tests.protocol.markers.figure import walking


def written(path, raw):
    n = len(raw.labels)
    lines = [
        f"PathFileType\t4\t(X/Y/Z)\t{path.name}",
        "DataRate\tCameraRate\tNumFrames\tNumMarkers\tUnits\tOrigDataRate\tOrigDataStartFrame\tOrigNumFrames",
        f"100\t100\t{len(raw.points)}\t{n}\tm\t100\t1\t{len(raw.points)}",
        "Frame#\tTime\t" + "\t\t\t".join(raw.labels) + "\t\t",
        "\t\t" + "\t".join(f"{axis}{k + 1}" for k in range(n) for axis in "XYZ"),
    ]
    for k, (t, row) in enumerate(zip(raw.t, raw.points, strict=True)):
        fields = ["" if np.isnan(x) else f"{x:.6f}" for x in row.ravel()]
        lines.append("\t".join([str(k + 1), f"{t:.3f}", *fields]))
    path.write_text("\n".join(lines) + "\n")
    return str(path)


def test_the_document_is_that_of_the_contract(tmp_path, capsys):
    raw = walking(seconds=3.0)
    raw.points[100:150, 0] = np.nan
    files = [written(tmp_path / name, raw) for name in ("b.trc", "a.trc")]
    assert main(["markers", *files, "--json"]) == 0
    document = json.loads(capsys.readouterr().out)
    assert [one["path"] for one in document["files"]] == files
    first = document["files"][0]
    assert (first["rate_hz"], first["frames"], first["unit"], first["up"], first["forces"]) == (
        100,
        300,
        "m",
        "+z",
        [],
    )
    assert first["markers"][0] == {"name": "head1", "missing": 50 / 300, "longest_gap_s": 0.5}
    (note,) = first["notes"]
    assert set(note) == {"kind", "markers", "from_s", "to_s", "text"}
    assert (note["kind"], note["markers"], note["from_s"], note["to_s"]) == ("gap", ["head1"], 1.0, 1.5)


def test_a_person_reads_a_table_and_sentences(tmp_path, capsys):
    raw = walking(seconds=3.0)
    raw.points[100:150, [0, 9]] = raw.points[100:150, [9, 0]]
    assert main(["markers", written(tmp_path / "walk.trc", raw)]) == 0
    shown = capsys.readouterr().out
    assert "walk.trc" in shown and "[swapped] head1 and thigh2" in shown.replace("\n", " ")


def test_what_cannot_be_read_is_one_sentence_and_exit_2(tmp_path, capsys):
    path = tmp_path / "no.c3d"
    path.write_bytes(b"none")
    assert main(["markers", str(path)]) == 2
    assert "no.c3d" in capsys.readouterr().err
