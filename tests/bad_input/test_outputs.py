"""Places that cannot be written to, and formats that nothing is written in."""

import numpy as np
import pytest

from fitter.data.motion_file import write_motion


@pytest.mark.parametrize("command", ["track", "sensors", "kinematics", "dynamics", "simulate"])
def test_a_place_that_cannot_be_written_to(said, short_run, columns, tmp_path, command):
    """It is said before the work is done, and no half of a file is left."""
    data = tmp_path / "data.npz"
    raw = {name: values[:4000] for name, values in short_run.raw_columns().items()}
    tip = np.zeros((len(columns["t"]), 3))
    write_motion(data, raw if command in ("track", "sensors") else columns | {"tip": tip})
    source = ("--reference", data) if command == "simulate" else (data,)
    (tmp_path / "file").write_text("of somebody")
    suffix = ".npz" if command in ("track", "simulate") else ".toml"
    for out, reason in (
        (tmp_path / "file" / f"below{suffix}", "Not a directory"),
        (tmp_path / "file" / "far" / f"below{suffix}", "Not a directory"),
        (tmp_path / f"folder{suffix}", "it is a directory"),
    ):
        if reason == "it is a directory":
            out.mkdir()
        sentence = said(3, command, *source, "--arm", "dd-arm", "--out", out)
        assert sentence.startswith(f"{out}: cannot be written: ")
        assert reason in sentence
    assert (tmp_path / "file").read_text() == "of somebody"
    assert {path.name for path in tmp_path.iterdir()} == {"data.npz", "file", f"folder{suffix}"}


@pytest.mark.parametrize("command", ["track", "simulate"])
def test_a_format_that_motions_are_not_written_in(said, short_run, columns, tmp_path, command):
    write_motion(tmp_path / "raw.npz", {name: v[:4000] for name, v in short_run.raw_columns().items()})
    write_motion(tmp_path / "ref.npz", columns)
    source = (tmp_path / "raw.npz",) if command == "track" else ("--reference", tmp_path / "ref.npz")
    sentence = said(2, command, *source, "--arm", "dd-arm", "--out", tmp_path / "m.xlsx")
    assert sentence == f"{tmp_path / 'm.xlsx'}: the suffix is '.xlsx', expected one of .csv, .parquet, .npz"
