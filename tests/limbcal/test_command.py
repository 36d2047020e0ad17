"""The door of every command, in this process and as a process of its own."""

import json
import os
import signal
import subprocess
import sys
import textwrap

import numpy as np
import pytest
from rich.table import Table

from limbcal.arguments import Parser, common_options
from limbcal.command import (
    ask,
    command_line,
    console,
    run_command,
    say,
    show,
)
from limbcal.errors import (
    ConfigError,
    DataError,
    DeviceError,
    LimbcalError,
    NotConverged,
    NotIdentifiable,
    ProtocolError,
)
from limbcal.note import Note
from tests.limbcal.acting import command, raising
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
