"""Whole files as trees."""

import json

import numpy as np
import pytest
import scipy.io

from limbcal.errors import DataError
from protocol.tables.trees import fields_of, fields_within, load_tree


def test_variables_of_matlab_are_read_when_they_are_asked_for(tmp_path, monkeypatch):
    path = tmp_path / "run.mat"
    scipy.io.savemat(path, {"t": np.arange(3.0), "log": {"q": np.arange(3.0)}, "huge": np.zeros((100, 100))})
    asked = []
    load = scipy.io.loadmat
    monkeypatch.setattr(
        "scipy.io.loadmat", lambda *a, **more: asked.append(more["variable_names"]) or load(*a, **more)
    )
    root, notes = load_tree(path)
    assert not asked and not notes and set(fields_of(root)) == {"t", "log", "huge"}
    assert list(fields_within(root, "log")) == ["q"] and not fields_within(root, "huge")
    assert root["t"].ravel().tolist() == [0.0, 1.0, 2.0]
    assert asked == [["log"], ["t"]]


def test_a_json_of_lines_needs_no_other_suffix(tmp_path):
    path = tmp_path / "run.json"
    path.write_text("\n".join(json.dumps({"t": k}) for k in range(3)))
    root, notes = load_tree(path)
    assert [record["t"].item() for record in root] == [0, 1, 2] and not notes


@pytest.mark.parametrize("content", ["[1, 2]", "3", '{"t": [1, 2}'])
def test_what_is_no_table_is_said(tmp_path, content):
    path = tmp_path / "run.json"
    path.write_text(content)
    with pytest.raises(DataError, match=r"run\.json: cannot be read as \.json"):
        load_tree(path)
