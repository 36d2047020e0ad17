"""The door of every command, in this process and as a process of its own."""

import io
import json
import os
import signal
import subprocess
import sys
import textwrap

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from rich.table import Table

from limbcal.arguments import Parser, common_options
from limbcal.command import (
    ask,
    command_line,
    console,
    emit,
    run_command,
    say,
    say_notes,
    show,
    strict_line,
    to_json,
)
from limbcal.errors import (
    ConfigError,
    DataError,
    DeviceError,
    LimbcalError,
    NotConverged,
    NotIdentifiable,
    ProtocolError,
    Unusable,
)
from limbcal.note import Note
from tests.patience import PATIENCE_S

EXIT_CODES = [
    (ConfigError, 2),
    (DataError, 2),
    (ProtocolError, 2),
    (DeviceError, 3),
    (NotIdentifiable, 4),
    (NotConverged, 4),
    (LimbcalError, 2),
]


def command(action):
    """Return a parser of one command that does what ``action`` does."""
    parser = Parser(prog="limbtest", parents=[common_options()])
    parser.add_argument("--size", type=int, default=1)
    parser.set_defaults(action=action)
    return parser


def raising(error):
    def action(_):
        raise error

    return action


@pytest.mark.parametrize(("error", "code"), EXIT_CODES)
def test_each_error_has_its_exit_code_and_is_said_on_stderr(capsys, error, code):
    assert run_command(command(raising(error("motion.csv, line 3: q2 is missing"))), ["--json"]) == code
    out, err = capsys.readouterr()
    assert out == ""
    assert err == "error: motion.csv, line 3: q2 is missing\n"


def test_every_mistake_is_a_line_of_its_own(capsys):
    error = ConfigError(["a.toml: joint[0].a_m is 'x'", "a.toml: [tip] is [red]wrong[/red]"])
    assert error.mistakes[1] == "a.toml: [tip] is [red]wrong[/red]"
    assert run_command(command(raising(error)), []) == 2
    assert capsys.readouterr().err == (
        "error: a.toml: joint[0].a_m is 'x'\nerror: a.toml: [tip] is [red]wrong[/red]\n"
    )


def test_a_long_sentence_stays_one_line(capsys):
    sentence = "a/very/long/path " * 40
    run_command(command(raising(DataError(sentence.strip()))), [])
    assert capsys.readouterr().err == f"error: {sentence.strip()}\n"


def test_debug_shows_where_it_came_from(capsys):
    def action(_):
        try:
            raise OSError("no such port")
        except OSError as error:
            raise DeviceError("/dev/limbcal: cannot be opened") from error

    assert run_command(command(action), ["--debug"]) == 3
    out, err = capsys.readouterr()
    assert out == "" and "Traceback" in err and "no such port" in err
    assert err.endswith("error: /dev/limbcal: cannot be opened\n")


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (["--size", "much"], "limbtest: argument --size: invalid int value: 'much'"),
        (["--sise", "3"], "limbtest: there is no option --sise; did you mean '--size'?"),
    ],
)
def test_wrong_arguments_are_told_like_every_other_mistake(capsys, arguments, words):
    assert run_command(command(lambda _: None), arguments) == 2
    out, err = capsys.readouterr()
    assert out == "" and err == f"error: {words}\n"


def test_json_is_the_only_thing_on_stdout(capsys):
    def action(namespace):
        console.print("[bold]working[/bold]")
        return {"size": namespace.size, "torque": np.array([1.5, np.nan])}

    assert run_command(command(action), ["--json", "--size", "3"]) == 0
    out, err = capsys.readouterr()
    assert json.loads(out) == {"size": 3, "torque": [1.5, None]}
    assert err == "working\n"


def test_without_json_stdout_holds_no_document(capsys):
    assert run_command(command(lambda _: {"size": 1}), []) == 0
    assert capsys.readouterr() == ("", "")


def test_an_answer_is_on_stdout_unless_that_is_the_documents(capsys):
    def action(_):
        table = Table("parameter", "value in m")
        table.add_row("a1", "0.25")
        show(table)
        show("[m] of the tip")
        say("a warning")
        return {"a1": 0.25}

    assert run_command(command(action), []) == 0
    out, err = capsys.readouterr()
    assert "value in m" in out and out.endswith("[m] of the tip\n") and err == "a warning\n"
    assert run_command(command(action), ["--json"]) == 0
    out, words = capsys.readouterr()
    assert json.loads(out) == {"a1": 0.25} and "value in m" in words and words.endswith("a warning\n")
    show("no command runs")
    assert capsys.readouterr().out == "no command runs\n"


def test_an_answer_that_nobody_can_take_is_a_failure_of_a_device(monkeypatch):
    class Full(io.StringIO):
        def flush(self):
            raise OSError(28, "No space left on device")

    monkeypatch.setattr("sys.stdout", Full())
    with pytest.raises(DeviceError, match="stdout cannot be written: No space left on device"):
        show("answer")
    sys.stdout.close()


def test_an_answer_that_nobody_can_act_on_is_printed_all_the_same(capsys):
    unusable = Unusable("next to nothing is explained", {"explained": 0.01})
    assert run_command(command(raising(unusable)), ["--json"]) == 4
    out, err = capsys.readouterr()
    assert json.loads(out) == {"explained": 0.01} and err == "error: next to nothing is explained\n"
    assert run_command(command(raising(unusable)), []) == 4
    assert capsys.readouterr().out == ""


def test_an_answer_may_be_nothing(capsys):
    assert run_command(command(lambda _: None), ["--json"]) == 0
    assert capsys.readouterr().out == ""


def test_a_stop_that_was_asked_for_is_a_success(capsys):
    assert run_command(command(raising(KeyboardInterrupt())), []) == 0
    assert capsys.readouterr().err == "stopped\n"


def test_a_mistake_of_our_own_is_not_hidden():
    with pytest.raises(ZeroDivisionError):
        run_command(command(lambda _: 1 / 0), [])


def test_the_handler_of_sigterm_is_put_back():
    before = signal.getsignal(signal.SIGTERM)
    for action in (lambda _: None, raising(DataError("x"))):
        run_command(command(action), [])
        assert signal.getsignal(signal.SIGTERM) is before


@pytest.mark.parametrize("sent", [signal.SIGTERM, signal.SIGINT])
def test_a_signal_closes_what_is_open(sent):
    """A process that is asked to stop runs its ``finally`` and leaves with 0."""
    program = textwrap.dedent("""
        import sys, time
        from limbcal.arguments import Parser, common_options
        from limbcal.command import emit, run_command

        def action(_):
            try:
                emit("ready")
                time.sleep(60)
            finally:
                emit("closed")

        parser = Parser(parents=[common_options()])
        parser.set_defaults(action=action)
        sys.exit(run_command(parser, []))
    """)
    pipe = subprocess.PIPE
    with subprocess.Popen([sys.executable, "-c", program], stdout=pipe, stderr=pipe, text=True) as process:
        try:
            assert process.stdout.readline() == "ready\n"
            os.kill(process.pid, sent)
            out, err = process.communicate(timeout=PATIENCE_S)
        finally:
            process.kill()
    assert (process.returncode, out, err) == (0, "closed\n", "stopped\n")


NUMBER = st.none() | st.booleans() | st.integers() | st.floats() | st.text()
DOCUMENT = st.recursive(
    NUMBER,
    lambda inner: st.lists(inner) | st.dictionaries(st.text(), inner) | st.tuples(inner, inner),
    max_leaves=10,
)


def strict(value):
    """Return what a document must come back as: lists for tuples, None for what is no number."""
    if isinstance(value, dict):
        return {key: strict(item) for key, item in value.items()}
    if isinstance(value, list | tuple):
        return [strict(item) for item in value]
    return None if isinstance(value, float) and not np.isfinite(value) else value


@settings(deadline=None)
@given(DOCUMENT)
def test_documents_are_strict_json(document):
    def refuse(constant):
        raise AssertionError(f"{constant} is not JSON")

    assert json.loads(to_json(document), parse_constant=refuse) == strict(document)


def test_numpys_values_are_written_as_numbers():
    document = {
        "scalar": np.float64(0.5),
        "whole": np.int64(3),
        "yes": np.bool_(True),
        "nan": np.float32("nan"),
        "matrix": np.array([[1.0, np.inf], [2.0, -np.inf]]),
        1: (),
    }
    assert json.loads(to_json(document)) == {
        "scalar": 0.5,
        "whole": 3,
        "yes": True,
        "nan": None,
        "matrix": [[1.0, None], [2.0, None]],
        "1": [],
    }


def test_emit_writes_a_line(capsys):
    emit("answer")
    assert capsys.readouterr() == ("answer\n", "")


def test_what_one_command_asks_is_not_said_by_the_next(capsys):
    doubts = [(), (Note("unit", "a_m is 300: millimetres?"),)]

    def act(_namespace):
        ask(doubts.pop())
        return {"notes": []}

    parser = Parser(parents=[common_options()])
    parser.set_defaults(action=act)
    kinds = []
    for _ in range(2):
        assert run_command(parser, ["--json"]) == 0
        kinds.append([note["kind"] for note in json.loads(capsys.readouterr().out)["notes"]])
    assert kinds == [["unit"], []]


def test_json_is_indented_by_two_or_in_one_line():
    document = {"a": [1, np.inf], "b": {}}
    assert to_json(document) == '{\n  "a": [\n    1,\n    null\n  ],\n  "b": {}\n}'
    assert strict_line(document) == '{"a": [1, null], "b": {}}'


def test_arguments_are_those_of_the_process_unless_given(monkeypatch, capsys):
    monkeypatch.setattr(sys, "argv", ["limbtest", "--json", "--size", "7"])
    assert run_command(command(lambda namespace: {"size": namespace.size}), None) == 0
    assert json.loads(capsys.readouterr().out) == {"size": 7}
    assert run_command(command(lambda namespace: {"size": namespace.size}), ["--json"]) == 0
    assert json.loads(capsys.readouterr().out) == {"size": 1}


@pytest.mark.parametrize("debug", [False, True])
@pytest.mark.parametrize(
    ("error", "code", "words"),
    [
        (MemoryError("8 GiB"), 3, "error: there is not enough memory for this (8 GiB); expected less data"),
        (DataError("no row"), 2, "error: no row"),
    ],
)
def test_a_traceback_is_shown_where_it_is_asked_for(capsys, debug, error, code, words):
    assert run_command(command(raising(error)), ["--debug"] if debug else []) == code
    out, err = capsys.readouterr()
    assert out == "" and words in err and ("Traceback" in err) == debug


def test_the_command_line_is_known_while_it_is_carried_out():
    lines = []
    assert run_command(command(lambda _: lines.append(command_line())), ["--size", "3"]) == 0
    assert (lines, command_line()) == (["limbtest --size 3"], "")


def test_notes_are_said_once_each(capsys):
    say_notes([Note("unit", "degrees?", "a"), Note("unit", "degrees?", "b"), Note("turn", "unwrapped")])
    assert capsys.readouterr().err == "a, b: degrees?\nunwrapped\n"


@pytest.mark.parametrize(
    ("document", "kinds"),
    [
        ({}, ["asked"]),
        ({"notes": []}, ["asked"]),
        ({"notes": [Note("other", "x").document()]}, ["asked", "other"]),
        ({"notes": [Note("asked", "what?").document()]}, ["asked"]),
    ],
)
def test_what_was_asked_stands_before_other_notes(capsys, document, kinds):
    def act(_):
        ask([Note("asked", "what?")])
        return document

    assert run_command(command(act), ["--json"]) == 0
    out, err = capsys.readouterr()
    assert [note["kind"] for note in json.loads(out)["notes"]] == kinds and err == "what?\n"


def test_notes_that_are_no_list_stay_what_they_are(capsys):
    def act(_):
        ask([Note("asked", "what?")])
        raise Unusable("no answer", {"notes": 3})

    assert run_command(command(act), ["--json"]) == 4
    assert json.loads(capsys.readouterr().out) == {"notes": 3}


def test_a_document_that_nobody_can_take_is_a_failure_of_a_device(monkeypatch, capsys):
    class Full(io.StringIO):
        def write(self, _):
            raise OSError(28, "No space left on device")

    monkeypatch.setattr("sys.stdout", Full())
    assert run_command(command(raising(Unusable("no answer", {"a": 1}))), ["--json"]) == 3
    sys.stdout.close()
    said = capsys.readouterr().err
    assert said == "error: no answer\nerror: stdout cannot be written: No space left on device\n"
