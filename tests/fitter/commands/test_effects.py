"""`fitter effects`: the catalogue, for people and for programs."""

import json

import pytest

from arm.effects.catalogue import catalogue
from fitter.__main__ import main


def test_the_list_is_the_catalogue(capsys):
    assert main(["effects", "--json"]) == 0
    listed = json.loads(capsys.readouterr().out)["effects"]
    assert [entry["name"] for entry in listed] == list(catalogue())
    (push,) = (entry for entry in listed if entry["name"] == "external_push")
    assert push["sentence"] == catalogue()["external_push"].sentence
    assert push["place"] == "joint" and push["acts_on"] == "joints" and "payload" in push["taken_for"]
    assert [(p["name"], p["unit"]) for p in push["parameters"]] == [
        ("start_s", "s"),
        ("duration_s", "s"),
        ("torque_N_m", "N m"),
        ("trials", "1"),
    ]
    acts_on = {entry["name"]: entry["acts_on"] for entry in listed}
    assert acts_on["payload"] == "arm" and acts_on["sensor_bias"] == "sensors"


@pytest.mark.parametrize("columns", ["80", "200"])
def test_every_effect_has_its_row_and_no_number_is_broken(columns, capsys, monkeypatch):
    monkeypatch.setenv("COLUMNS", columns)
    assert main(["effects"]) == 0
    shown = capsys.readouterr()
    assert not shown.err
    for name in catalogue():
        assert f" {name} " in shown.out
    assert "damping_N_m_s [N m s/rad]" in shown.out and "since_s [s], if wanted" in shown.out
