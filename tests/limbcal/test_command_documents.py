"""What a command answers with: strict JSON, notes in their order, and nobody who takes it."""

import io
import json
import sys

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from limbcal.command import (
    ask,
    emit,
    run_command,
    say_notes,
    show,
    strict_line,
    to_json,
)
from limbcal.errors import (
    DeviceError,
    Unusable,
)
from limbcal.note import Note
from tests.limbcal.acting import command, raising


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


def test_json_is_indented_by_two_or_in_one_line():
    document = {"a": [1, np.inf], "b": {}}
    assert to_json(document) == '{\n  "a": [\n    1,\n    null\n  ],\n  "b": {}\n}'
    assert strict_line(document) == '{"a": [1, null], "b": {}}'


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
