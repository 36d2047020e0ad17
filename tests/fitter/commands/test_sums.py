"""`fitter sums`."""

import json

import numpy as np
import pytest

from fitter.__main__ import main
from fitter.regression_sums.saved_sums import is_sums, load_sums


def run(capsys, *arguments):
    code = main([str(argument) for argument in arguments])
    return code, *capsys.readouterr()


def test_sums_are_made_and_added(trial_files, tmp_path, capsys):
    learn, other = trial_files
    parts = [tmp_path / "a.npz", tmp_path / "b.npz"]
    for data, out in zip((learn, other), parts, strict=True):
        command = ("sums", "make", data, "--arm", "dd-arm", "--cutoff-hz", 20, "--out", out, "--json")
        code, stdout, _ = run(capsys, *command)
        assert code == 0
        document = json.loads(stdout)
        assert document["samples"] == load_sums(out).sums.samples > 0
        assert document["cutoff_hz"] == 20.0
        assert document["parameters"][0] == "I1+m2*L1^2"
    code, stdout, said = run(capsys, "sums", "add", *parts, "--out", tmp_path / "c.npz", "--json")
    assert code == 0
    assert json.loads(stdout)["trials"] == ["learn/1", "learn/2", "evaluate/3"]
    assert "3 trial(s)" in said
    assert is_sums(tmp_path / "c.npz")
    both = tmp_path / "both.npz"
    command = ("sums", "make", learn, other, "--arm", "dd-arm", "--cutoff-hz", 20, "--out", both)
    assert run(capsys, *command)[:2] == (0, f"{both}: 12625 samples of 3 trial(s)\n")
    assert both.read_bytes() == (tmp_path / "c.npz").read_bytes()


@pytest.mark.parametrize("place", ["before", "after"])
def test_json_may_stand_before_or_after(trial_files, tmp_path, capsys, place):
    options = ("--json",)
    command = ("make", trial_files[0], "--arm", "dd-arm", "--cutoff-hz", 20, "--out", tmp_path / "a.npz")
    arguments = (*options, *command) if place == "before" else (*command, *options)
    assert json.loads(run(capsys, "sums", *arguments)[1])["out"].endswith("a.npz")


def test_what_cannot_be_added_is_said(trial_files, tmp_path, capsys):
    for arm in ("dd-arm", "dd-arm-vertical"):
        command = ("make", trial_files[0], "--arm", arm, "--cutoff-hz", 20, "--out", tmp_path / f"{arm}.npz")
        assert run(capsys, "sums", *command)[0] == 0
    flat, vertical = tmp_path / "dd-arm.npz", tmp_path / "dd-arm-vertical.npz"
    for parts, code, said in (
        ((flat, vertical), 2, "these sums are of another arm or law: gravity_m_s2 is"),
        ((flat, flat), 2, "expected sums of different trials"),
        ((flat, trial_files[0]), 2, "cannot be read as sums"),
        ((flat, tmp_path / "none.npz"), 2, "there is no such file"),
    ):
        found, stdout, stderr = run(capsys, "sums", "add", *parts, "--out", tmp_path / "c.npz")
        assert (found, stdout) == (code, "")
        assert said in " ".join(stderr.split())
    assert not (tmp_path / "c.npz").exists()


@pytest.mark.parametrize(
    ("options", "said"),
    [
        (("--out", "a.csv"), "expected one of .npz"),
        (("--out", "a.npz", "--workers", "0"), "'0' is not a whole number of at least 1"),
        (("--out", "a.npz", "--dask", "here"), "expected a scheduler's address"),
    ],
)
def test_wrong_arguments_are_said(trial_files, tmp_path, capsys, monkeypatch, options, said):
    monkeypatch.chdir(tmp_path)
    code, stdout, stderr = run(capsys, "sums", "make", trial_files[0], "--arm", "dd-arm", *options)
    assert (code, stdout) == (2, "")
    assert said in " ".join(stderr.split())


def test_sums_of_a_file_named_by_its_rate(trial_files, tmp_path, capsys):
    assert np.isfinite(load_sums_of(trial_files[1], tmp_path, capsys).sums.gram).all()


def load_sums_of(data, tmp_path, capsys):
    out = tmp_path / "s.npz"
    assert run(capsys, "sums", "make", data, "--arm", "dd-arm", "--rate-hz", 250, "--out", out)[0] == 0
    return load_sums(out)
