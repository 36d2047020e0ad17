"""Options that do not exist, make no sense, or do not fit the data."""

from dataclasses import replace

import pytest

import fitter.__main__
from arm.arm_file import save_arm
from fitter.data.motion_file import write_motion


@pytest.mark.parametrize(
    ("arguments", "sentence"),
    [
        ((), "fitter: COMMAND missing"),
        (("calibrate",), "fitter: there is no command 'calibrate', expected one of subscribe, track, "),
        (("dynamics", "a.csv"), "fitter dynamics: --arm, --out missing"),
        (("dynamics", "a.csv", "--arm", "dd-arm", "--out", "b.toml", "--what"), "there is no option --what"),
        (("dynamics", "a.csv", "--arm", "dd-arm", "--out", "b.toml", "--seed", "-1"), "argument --seed"),
        (("dynamics", "a.csv", "--arm", "dd-arm", "--out", "b.toml", "--seed", "x"), "'x' is not a whole number"),
        (("kinematics", "a.csv", "--arm", "dd-arm", "--out", "b.toml", "--population", "9"), "of at least 10"),
        (("kinematics", "a.csv", "--arm", "dd-arm", "--out", "b.toml", "--generations", "0"), "of at least 1"),
        (("track", "a.csv", "--arm", "dd-arm", "--out", "b.npz", "--frame-rate-hz", "0"), "'0' is not a number"),
        (("track", "a.csv", "--arm", "dd-arm", "--out", "b.npz", "--method", "guess"), "no value 'guess'"),
        (("subscribe", "--trials", "0"), "argument --trials: '0' is not a whole number of at least 1"),
        (("subscribe", "--seconds", "soon"), "argument --seconds: 'soon' is not a number above 0"),
    ],
)
def test_options_that_do_not_exist_or_make_no_sense(said, arguments, sentence):
    assert sentence in said(2, *arguments)


def test_values_that_do_not_fit_the_arm(said, motion, short_run, tmp_path):
    fit = ("dynamics", motion, "--arm", "dd-arm", "--out", tmp_path / "arm.toml")
    assert "no base parameter is called I3; this arm has I1+m2*L1^2, " in said(2, *fit, "--fix", "I3=1")
    assert "no base parameter is called mass" in said(2, *fit, "--bounds", "mass=0:1")
    assert "bounds of I2 are 3.0 and 1.0, expected finite and ordered" in said(2, *fit, "--bounds", "I2=3:1")
    assert "--fix I2: 'x' is not a number" in said(2, *fit, "--fix", "I2=x")
    write_motion(tmp_path / "raw.npz", {name: values[:4000] for name, values in short_run.raw_columns().items()})
    track = ("track", tmp_path / "raw.npz", "--arm", "dd-arm", "--out", tmp_path / "m.npz")
    assert said(2, *track, "--initial-q", "1") == "--initial-q has 1 numbers, expected one a joint (2)"
    assert "--initial-q is 'a,b', expected numbers" in said(2, *track, "--initial-q", "a,b")
    assert not (tmp_path / "m.npz").exists() and not (tmp_path / "arm.toml").exists()


def test_an_arm_that_does_not_exist(said, motion, tmp_path):
    fit = ("dynamics", motion, "--out", tmp_path / "arm.toml")
    names = (
        "dd-arm, dd-arm-vertical, human-arm-left, human-arm-right, human-body, human-leg-left, "
        "human-leg-right, spatial-arm"
    )
    known = f"No such file or directory; expected an arm file or one of {names}"
    assert said(2, *fit, "--arm", "dd-leg") == f"arm 'dd-leg': {known}"
    assert said(2, *fit, "--arm", "dd-arm", "--compare", "dd-leg") == f"arm 'dd-leg': {known}"


@pytest.mark.parametrize("method", ["filter", "smooth"])
def test_when_to_zero_is_asked_by_the_papers_method_only(said, a_second, tmp_path, method):
    track = ("track", a_second, "--arm", "dd-arm", "--out", tmp_path / "m.npz", "--method", method)
    sentence = said(2, *track, "--zero", "each-rest")
    assert sentence == f"--zero is 'each-rest', expected it only with --method integrate, not {method}"
    assert not (tmp_path / "m.npz").exists()


@pytest.mark.parametrize("command", ["track", "sensors"])
def test_where_the_arm_rests_in_other_words(said, a_second, tmp_path, command):
    common = (command, a_second, "--arm", "dd-arm", "--out", tmp_path / "out.npz", "--initial-q")
    assert said(2, *common, "1,2,3") == "--initial-q has 3 numbers, expected one a joint (2)"
    assert said(2, *common, "north") == "--initial-q is 'north', expected numbers parted by commas"


@pytest.mark.parametrize("command", ["track", "sensors"])
def test_an_arm_without_sensors_reads_nothing(said, short_run, a_second, tmp_path, command):
    save_arm(replace(short_run.arm, sensors=(), tip=None), tmp_path / "blind.toml")
    sentence = said(2, command, a_second, "--arm", tmp_path / "blind.toml", "--out", tmp_path / "out.npz")
    assert sentence.startswith("the arm has no [[sensor]], expected ")


@pytest.mark.parametrize("option", ["--scale-std", "--turn-std-deg", "--place-std-mm", "--highpass-hz"])
def test_how_far_off_sensors_are_is_a_positive_number(said, a_second, tmp_path, option):
    common = ("sensors", a_second, "--arm", "dd-arm", "--out", tmp_path / "arm.toml", option)
    for text in ("0", "-1", "much"):
        assert said(2, *common, text).endswith(f"argument {option}: '{text}' is not a number above 0")


def test_a_rate_beyond_all_memory(said, motion, tmp_path):
    fit = ("dynamics", motion, "--arm", "dd-arm", "--out", tmp_path / "arm.toml", "--rate-hz", "1e15")
    assert said(2, *fit).startswith(f"rate_hz is 1e+15, but {motion} has 100 rows a second, expected at most 100")


def test_a_traceback_only_where_it_is_asked_for(capfd, motion, tmp_path):
    arguments = ["dynamics", "nothing.csv", "--arm", "dd-arm", "--out", str(tmp_path / "arm.toml")]
    assert fitter.__main__.main([*arguments, "--debug"]) == 2
    assert "Traceback" in capfd.readouterr().err
