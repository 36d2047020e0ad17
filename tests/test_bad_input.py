"""What is wrong is said in one clear sentence that names where; the exit code says of what kind it is."""

import json
import os
import select
import subprocess
import sys
import tempfile
import threading
import tty
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass, replace

import numpy as np
import pytest
import zmq

import daemon.__main__
import fitter.__main__
from arm.arm_file import save_arm
from arm.model import Control
from fitter.data.motion_file import write_motion
from protocol.message import FRAMES, encode
from protocol.publisher import Publisher

PATIENCE_S = 60.0


@dataclass(frozen=True)
class Outcome:
    """Exit code, stdout, and the sentences of an error."""

    code: int
    out: str
    errors: list[str]


@pytest.fixture
def run(capfd: pytest.CaptureFixture[str]) -> Callable[..., Outcome]:
    """Run a command: ``run(fitter.__main__.main, "track", …)``; whatever happens, no traceback."""

    def outcome(main: Callable[[list[str]], int], *arguments: object) -> Outcome:
        code = main([str(argument) for argument in arguments])
        out, err = capfd.readouterr()
        assert "Traceback" not in err
        return Outcome(code, out, [line for line in err.splitlines() if line.startswith("error: ")])

    return outcome


@pytest.fixture
def said(run: Callable[..., Outcome]) -> Callable[..., str]:
    """Run ``fitter``; return the one sentence of an error with this exit code, and no word of it on stdout."""

    def sentence(code: int, *arguments: object) -> str:
        outcome = run(fitter.__main__.main, *arguments, "--json")
        assert (outcome.code, outcome.out, len(outcome.errors)) == (code, "", 1), outcome
        return outcome.errors[0].removeprefix("error: ")

    return sentence


@pytest.fixture
def columns(short_run):
    """Return two seconds of motion at 100 Hz, with targets."""
    rows = slice(2000, 10000, 40)
    return {"t": short_run.t[rows], "q": short_run.truth["q"][rows], "ref": short_run.truth["ref"][rows]}


@pytest.fixture
def motion(columns, tmp_path):
    """Write them."""
    write_motion(tmp_path / "motion.csv", columns)
    return tmp_path / "motion.csv"


@pytest.fixture
def measuring(short_run, tmp_path):
    """Write an arm whose torque comes with the data."""
    save_arm(replace(short_run.arm, control=Control("measured")), tmp_path / "measuring.toml")
    return tmp_path / "measuring.toml"


BAD_ARM = """\
schema = 1
name = "ours"

[[joint]]
type = "hinge"

[[joint]]
a_m = "0.3"

[[sensor]]
name = "s1"
joint = 1
colour = "red"
"""
ARM_MISTAKES = {
    "joint[0].type is 'hinge'; input should be 'revolute' or 'prismatic'",
    "joint[1].a_m is '0.3'; input should be a valid number",
    "sensor[0].colour is not a known field",
}


@pytest.mark.parametrize(
    "command",
    [
        ("track", "raw.npz", "--out", "motion.npz"),
        ("sensors", "raw.npz", "--out", "arm.toml"),
        ("kinematics", "motion.csv", "--out", "arm.toml"),
        ("dynamics", "motion.csv", "--out", "arm.toml"),
        ("simulate", "--reference", "motion.csv", "--out", "motion.npz"),
        ("subscribe",),
    ],
)
def test_three_mistakes_in_an_arm_file_are_all_named(run, tmp_path, command):
    path = tmp_path / "arm.toml"
    path.write_text(BAD_ARM)
    outcome = run(fitter.__main__.main, *command, "--arm", path)
    assert outcome.code == 2
    assert set(outcome.errors) == {f"error: {path}: {mistake}" for mistake in ARM_MISTAKES}


def test_what_only_follows_from_a_mistake_is_not_one(run, tmp_path):
    path = tmp_path / "arm.toml"
    for text, mistake in (
        ('schema = 1\nname = "x"\n[[joint]]\na = 1\n', "joint[0].a is not a known field"),
        ('schema = 1\nname = "x"\njoint = []\n', "joint is []; tuple should have at least 1 item"),
        ('schema = 1\nname = "x"\n[[joint]]\nlink = { com_m = [0.0, 0.0] }\n', "joint[0].link.com_m"),
    ):
        path.write_text(text)
        outcome = run(fitter.__main__.main, "subscribe", "--arm", path)
        assert outcome.code == 2 and len(outcome.errors) == 1
        assert f"{path}: {mistake}" in outcome.errors[0]


BAD_CONFIG = """\
[device]
port = 5
[arm]
file = "dd-arm"
[tracking]
method = "guess"
[record]
folder = "recordings"
directory = "recordings"
"""
CONFIG_MISTAKES = {
    "device.port is 5; input should be a valid string",
    "tracking.method is 'guess'; input should be 'filter' or 'integrate'",
    "record.folder is not a known field",
}


def test_three_mistakes_in_a_config_are_all_named(run, tmp_path):
    path = tmp_path / "limbd.toml"
    path.write_text(BAD_CONFIG)
    expected = {f"{path}: {mistake}" for mistake in CONFIG_MISTAKES}
    for arguments in (("check", path), ("run", "--config", path)):
        outcome = run(daemon.__main__.main, *arguments)
        assert outcome.code == 2 and outcome.out == ""
        assert set(outcome.errors) == {f"error: {mistake}" for mistake in expected}
    outcome = run(daemon.__main__.main, "check", path, "--json")
    assert outcome.code == 2
    assert set(json.loads(outcome.out)["mistakes"]) == expected


def test_files_that_are_not_toml(run, said, tmp_path):
    path = tmp_path / "broken.toml"
    path.write_text("schema = = 1\n")
    assert said(2, "subscribe", "--arm", path).startswith(f"{path}: not TOML: ")
    outcome = run(daemon.__main__.main, "check", path)
    assert outcome.code == 2 and f"{path}: not TOML: " in outcome.errors[0]


@pytest.mark.parametrize(
    ("arguments", "sentence"),
    [
        ((), "fitter: the following arguments are required: COMMAND"),
        (("calibrate",), "fitter: argument COMMAND: invalid choice: 'calibrate'"),
        (("dynamics", "a.csv"), "fitter dynamics: the following arguments are required: --arm, --out"),
        (("dynamics", "a.csv", "--arm", "dd-arm", "--out", "b.toml", "--what"), "unrecognized arguments: --what"),
        (("dynamics", "a.csv", "--arm", "dd-arm", "--out", "b.toml", "--seed", "-1"), "argument --seed"),
        (("dynamics", "a.csv", "--arm", "dd-arm", "--out", "b.toml", "--seed", "x"), "'x' is not a whole number"),
        (("kinematics", "a.csv", "--arm", "dd-arm", "--out", "b.toml", "--population", "9"), "of at least 10"),
        (("kinematics", "a.csv", "--arm", "dd-arm", "--out", "b.toml", "--generations", "0"), "of at least 1"),
        (("track", "a.csv", "--arm", "dd-arm", "--out", "b.npz", "--frame-rate-hz", "0"), "'0' is not a number"),
        (("track", "a.csv", "--arm", "dd-arm", "--out", "b.npz", "--method", "guess"), "invalid choice: 'guess'"),
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
    known = "No such file or directory; expected an arm file or one of dd-arm, dd-arm-vertical, spatial-arm"
    assert said(2, *fit, "--arm", "dd-leg") == f"arm 'dd-leg': {known}"
    assert said(2, *fit, "--arm", "dd-arm", "--compare", "dd-leg") == f"arm 'dd-leg': {known}"


COMMANDS = [("kinematics", "--out", "arm.toml"), ("dynamics", "--out", "arm.toml"), ("track", "--out", "m.npz")]


@pytest.mark.parametrize("command", COMMANDS, ids=lambda command: command[0])
def test_data_that_does_not_exist(said, tmp_path, monkeypatch, command):
    monkeypatch.chdir(tmp_path)
    name, *out = command
    here = (name, "--arm", "dd-arm", *out)
    assert said(2, *here, "nothing.csv") == "nothing.csv: there is no such file or folder"
    (tmp_path / "empty").mkdir()
    assert "empty: no data file in this folder, expected .csv" in said(2, *here, "empty")
    (tmp_path / "notes.txt").write_text("q1, q2")
    assert "notes.txt: the suffix is '.txt', expected one of .csv" in said(2, *here, "notes.txt")
    assert sorted(path.name for path in tmp_path.iterdir()) == ["empty", "notes.txt"]


@pytest.mark.parametrize("suffix", ["csv", "parquet", "npz", "mat", "json", "mcap"])
def test_data_that_is_not_what_its_name_says(said, tmp_path, suffix):
    path = tmp_path / f"noise.{suffix}"
    path.write_bytes(np.random.default_rng(0).bytes(1000))
    for command in ("kinematics", "dynamics"):
        sentence = said(2, command, path, "--arm", "dd-arm", "--out", tmp_path / "arm.toml")
        assert sentence.startswith(str(path))
    path.write_bytes(b"")
    assert said(2, "dynamics", path, "--arm", "dd-arm", "--out", tmp_path / "arm.toml").startswith(str(path))


def test_columns_that_are_not_there(said, motion, tmp_path):
    fit = ("dynamics", motion, "--arm", "dd-arm", "--out", tmp_path / "arm.toml")
    among = "among its columns t, q1, q2, ref1, ref2"
    assert said(2, *fit, "--columns", "q=angle{j}") == f"{motion}: no column 'angle1' {among}"
    assert said(2, *fit, "--columns", "tau=torque_{j}") == f"{motion}: no column 'torque_1' {among}"
    track = ("track", motion, "--arm", "dd-arm", "--out", tmp_path / "m.npz")
    assert said(2, *track) == f"{motion}: no column 's1x' {among}"
    simulate = ("simulate", "--reference", motion, "--arm", "dd-arm", "--out", tmp_path / "m.npz")
    assert "no column 'goal1'" in said(2, *simulate, "--columns", "ref=goal{j}")


def test_every_mistake_in_a_mapping_is_named(run, motion, tmp_path):
    fit = ("dynamics", motion, "--arm", "dd-arm", "--out", tmp_path / "arm.toml")
    outcome = run(fitter.__main__.main, *fit, "--columns", "q=angle,time=t,q9=a,oops")
    assert outcome.code == 2 and len(outcome.errors) == 4
    for entry, error in zip(("q=angle", "time=t", "q9=a", "oops"), outcome.errors, strict=True):
        assert error.startswith(f"error: --columns, entry '{entry}': ")


@pytest.mark.parametrize("suffix", [".csv", ".parquet", ".npz"])
def test_a_value_that_is_not_a_number(said, columns, tmp_path, suffix):
    path = tmp_path / f"motion{suffix}"
    q = columns["q"].copy()
    q[41, 1] = np.nan
    write_motion(path, columns | {"q": q})
    for command in ("dynamics", "kinematics"):
        sentence = said(2, command, path, "--arm", "dd-arm", "--out", tmp_path / "arm.toml")
        assert sentence.startswith(str(path)) and "q2" in sentence and "row 42: " in sentence
        assert sentence.endswith("found nothing or NaN, expected a finite number")
    sentence = said(2, "simulate", "--reference", path, "--arm", "dd-arm", "--out", tmp_path / "m.npz")
    assert "q2" in sentence and "row 42: " in sentence


def test_words_where_a_number_should_be(said, motion, tmp_path):
    lines = motion.read_text().splitlines()
    lines[10] = lines[10].replace(",", ",oops", 1)
    motion.write_text("\n".join(lines))
    sentence = said(2, "dynamics", motion, "--arm", "dd-arm", "--out", tmp_path / "arm.toml")
    assert sentence.startswith(f"{motion}: row 10: column 'q1' holds 'oops")


def test_time_that_runs_backwards_or_stands_still(said, columns, tmp_path):
    path, t = tmp_path / "motion.csv", columns["t"].copy()
    for wrong, word in ((t[50], "runs backwards from"), (t[99], "stands still at")):
        t[100] = wrong
        write_motion(path, columns | {"t": t})
        for command in (
            ("dynamics", path, "--out", tmp_path / "arm.toml"),
            ("simulate", "--reference", path, "--out", tmp_path / "m.npz"),
        ):
            sentence = said(2, *command, "--arm", "dd-arm")
            assert sentence.startswith(f"{path}: in row 101 time {word}")


def test_readings_whose_time_runs_backwards(said, short_run, tmp_path):
    raw = {name: values[:1000].copy() for name, values in short_run.raw_columns().items()}
    raw["t"][500] = 0.0
    write_motion(tmp_path / "raw.npz", raw)
    sentence = said(2, "track", tmp_path / "raw.npz", "--arm", "dd-arm", "--out", tmp_path / "m.npz")
    assert sentence.startswith(f"{tmp_path / 'raw.npz'}: in row 501 time runs backwards from")


@pytest.fixture
def a_second(short_run, tmp_path):
    """Write a second of readings, in which the arm begins to move."""
    path = tmp_path / "raw.npz"
    write_motion(path, {name: values[:4000] for name, values in short_run.raw_columns().items()})
    return path


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


def test_a_trial_too_short(said, columns, short_run, tmp_path):
    path = tmp_path / "motion.csv"
    write_motion(path, {name: values[:10] for name, values in columns.items()})
    expected = f"{path}: trial 'motion' has 10 samples, expected at least 16"
    for command in ("dynamics", "kinematics"):
        assert said(2, command, path, "--arm", "dd-arm", "--out", tmp_path / "arm.toml") == expected
    assert said(2, "simulate", "--reference", path, "--arm", "dd-arm", "--out", tmp_path / "m.npz") == expected
    write_motion(tmp_path / "raw.csv", {name: values[:10] for name, values in short_run.raw_columns().items()})
    for command in ("track", "sensors"):
        sentence = said(2, command, tmp_path / "raw.csv", "--arm", "dd-arm", "--out", tmp_path / "m.npz")
        assert sentence == f"{tmp_path / 'raw.csv'}: run 'raw' has 10 samples, expected at least 16"


def test_more_joints_than_the_arm_has(said, columns, tmp_path):
    path = tmp_path / "motion.csv"
    write_motion(path, columns | {"q": np.tile(columns["q"], (1, 2)), "ref": np.tile(columns["ref"], (1, 2))})
    sentence = said(2, "dynamics", path, "--arm", "dd-arm", "--out", tmp_path / "arm.toml")
    assert sentence == f"{path}: there is a column 'q3', but the arm has 2 joints"


def test_trials_that_are_learnt_from_cannot_evaluate(said, motion, tmp_path):
    for command in ("dynamics", "kinematics"):
        arguments = (command, motion, "--evaluate", motion, "--arm", "dd-arm", "--out", tmp_path / "arm.toml")
        assert said(2, *arguments) == f"--evaluate: {motion} is learnt from, expected trials that are not"


def test_a_law_of_measured_torque_needs_torque(said, motion, measuring, tmp_path):
    sentence = said(2, "dynamics", motion, "--arm", measuring, "--out", tmp_path / "arm.toml")
    assert sentence.startswith("trial motion: has no torque, but control.law of arm dd-arm is 'measured'")
    sentence = said(2, "simulate", "--reference", motion, "--arm", measuring, "--out", tmp_path / "m.npz")
    assert sentence.startswith(f"{motion}: no column 'tau1' among")


def test_a_motion_without_a_tip_tells_no_geometry(said, motion, tmp_path):
    sentence = said(2, "kinematics", motion, "--arm", "dd-arm", "--out", tmp_path / "arm.toml")
    assert sentence == "trial motion: has no tip; expected columns tipx, tipy and tipz"


def test_a_trial_in_which_nothing_moves_answers_nothing(said, columns, measuring, tmp_path):
    still = {name: values if name == "t" else np.full_like(values, 0.3) for name, values in columns.items()}
    tip, tau = np.full((len(still["t"]), 3), 0.5), np.ones_like(still["q"])
    path, out = tmp_path / "still.csv", tmp_path / "arm.toml"
    write_motion(path, still | {"tip": tip, "tau": tau})
    samples = len(tip)
    sentence = said(4, "kinematics", path, "--arm", "dd-arm", "--out", out)
    assert sentence.startswith(f"no geometric parameter can be told from {samples} samples")
    for arm in ("dd-arm", measuring):
        sentence = said(4, "dynamics", path, "--arm", arm, "--out", out)
        assert f"{samples} samples" in sentence
    assert not out.exists()


def test_a_search_that_is_cut_short_is_no_answer(said, trial_files, tmp_path):
    fit = ("dynamics", trial_files[0], "--arm", "dd-arm", "--out", tmp_path / "arm.toml", "--generations", "2")
    assert said(4, *fit).startswith("after 2 generations of 100 the cost ")
    assert not (tmp_path / "arm.toml").exists()


@pytest.mark.parametrize("command", ["track", "sensors", "kinematics", "dynamics", "simulate"])
def test_a_place_that_cannot_be_written_to(said, short_run, columns, tmp_path, command):
    """It is told before the work is done, and no half of a file is left."""
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


def test_a_rate_beyond_all_memory(said, motion, tmp_path):
    fit = ("dynamics", motion, "--arm", "dd-arm", "--out", tmp_path / "arm.toml", "--rate-hz", "1e15")
    assert said(3, *fit).startswith("there is not enough memory for this")


def test_a_traceback_only_where_it_is_asked_for(capfd, motion, tmp_path):
    arguments = ["dynamics", "nothing.csv", "--arm", "dd-arm", "--out", str(tmp_path / "arm.toml")]
    assert fitter.__main__.main([*arguments, "--debug"]) == 2
    assert "Traceback" in capfd.readouterr().err


@pytest.mark.parametrize("arm", [("--arm", "dd-arm"), ()], ids=["with an arm", "without"])
def test_a_message_of_another_version(said, stream, short_run, arm):
    topic, fields = short_run.messages[0]
    payload = encode(topic, fields)[1].replace(b"\xa1v\x01", b"\xa1v\x07")
    with tempfile.TemporaryDirectory() as place, stream("tcp://127.0.0.1:*", [[FRAMES.encode(), payload]]) as told:
        common = ("--connect", told.endpoint, "--endpoint", f"ipc://{place}/fits", "--seconds", "60")
        assert said(2, "subscribe", *common, *arm) == "limb/frames: message version is 7, expected 1"


def test_an_endpoint_that_is_taken(said):
    with tempfile.TemporaryDirectory() as place, zmq.Context() as context:
        with Publisher(context, "tcp://127.0.0.1:*", "x", "y") as publisher:
            common = ("--connect", f"ipc://{place}/frames", "--endpoint", publisher.endpoint, "--arm", "dd-arm")
            sentence = said(3, "subscribe", *common)
    assert sentence == f"endpoint {publisher.endpoint} is already taken, expected a free one"


def limbd(*arguments: object) -> subprocess.CompletedProcess[str]:
    command = [sys.executable, "-m", "daemon", *map(str, arguments)]
    return subprocess.run(command, capture_output=True, text=True, timeout=PATIENCE_S, check=False)


def sentence_of(process: subprocess.CompletedProcess[str]) -> str:
    assert "Traceback" not in process.stderr
    (error,) = [line for line in process.stderr.splitlines() if line.startswith("error: ")]
    return error.removeprefix("error: ")


@pytest.mark.skipif(not os.path.exists("/dev/full"), reason="there is no disk that is always full")
def test_an_answer_that_nobody_can_take(tmp_path):
    (tmp_path / "limbd.toml").write_text('[device]\nport = "/dev/limbcal"\n[arm]\nfile = "dd-arm"\n')
    command = [sys.executable, "-m", "daemon", "check", str(tmp_path / "limbd.toml"), "--json"]
    with open("/dev/full", "w", encoding="utf-8") as full:
        process = subprocess.run(command, stdout=full, stderr=subprocess.PIPE, text=True, check=False)
    assert process.returncode == 3
    assert sentence_of(process) == "stdout cannot be written: No space left on device"


def test_a_port_that_does_not_exist():
    process = limbd("run", "--port", "/dev/nope", "--arm", "dd-arm")
    assert process.returncode == 3
    assert sentence_of(process) == "port /dev/nope does not exist, expected the serial port of the device"


@contextmanager
def babbling_port() -> Iterator[str]:
    """Open a pseudo-terminal on which somebody sends noise, and only noise."""
    master, slave = os.openpty()
    tty.setraw(slave)
    os.set_blocking(master, False)
    over, noise = threading.Event(), np.random.default_rng(0).bytes(4096)

    def babble() -> None:
        while not over.is_set():
            if select.select([], [master], [], 0.05)[1]:
                os.write(master, noise)

    thread = threading.Thread(target=babble)
    thread.start()
    try:
        yield os.ttyname(slave)
    finally:
        over.set()
        thread.join()
        os.close(master)
        os.close(slave)


def test_a_device_that_sends_garbage():
    with babbling_port() as port:
        process = limbd("run", "--port", port, "--arm", "dd-arm", "--endpoint", "tcp://127.0.0.1:*")
    assert process.returncode == 3
    assert sentence_of(process).startswith(f"port {port}: no valid frame in ")


def test_a_port_that_is_taken(tmp_path):
    """Two daemons want the same device; the first one goes on."""
    device = subprocess.Popen(
        [sys.executable, "-m", "daemon", "virtual", "--rate-hz", "4000", "--trials", "1", "--json"],
        stdout=subprocess.PIPE,
        stderr=subprocess.DEVNULL,
        text=True,
    )
    first = None
    try:
        port = json.loads(device.stdout.readline())["port"]
        command = [sys.executable, "-m", "daemon", "run", "--port", port, "--arm", "dd-arm", "--json"]
        command += ["--endpoint", "tcp://127.0.0.1:*"]
        first = subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, text=True)
        assert json.loads(first.stdout.readline())["endpoint"].startswith("tcp://127.0.0.1:")
        second = limbd("run", "--port", port, "--arm", "dd-arm", "--endpoint", "tcp://127.0.0.1:*")
        assert second.returncode == 3
        assert sentence_of(second).startswith(f"port {port} is already taken")
        assert first.poll() is None
    finally:
        for process in (first, device):
            if process is not None:
                process.terminate()
                process.communicate(timeout=PATIENCE_S)
    assert first.returncode == device.returncode == 0
