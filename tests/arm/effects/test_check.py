"""Mistakes in an arm's effects: every one is a sentence that names its field."""

from dataclasses import replace

import numpy as np
import pytest

from arm.effects.check import effect_mistakes, mistakes_in
from arm.model import Effect, Marker
from arm.simulation import simulate
from limbcal.errors import ConfigError

SENSORS, MARKERS = ["s1", "s4"], ["A", "B"]


def mistakes(*effects, n_joint=2):
    return list(mistakes_in(effects, n_joint, SENSORS, MARKERS))


def entry(name, numbers=None, **on):
    return {"name": name, "parameters": numbers or {}, **on}


@pytest.mark.parametrize(
    ("effect", "sentence"),
    [
        (entry("magic"), "effect[0].name is 'magic', expected one of actuator_delay, actuator_lag, air_drag, "),
        (entry("viscuos"), "; did you mean 'viscous'?"),
        (entry("viscous", {"viscous_N_m_s": 1}, joints=[3]), "effect[0].joints has 3, expected 1 to 2"),
        (entry("viscous", {"viscous_N_m_s": 1}, joints=[2, 0]), "effect[0].joints has 0, expected 1 to 2"),
        (entry("viscous", {"viscous_N_m_s": 1}), "effect[0].joints is missing: viscous acts on joints"),
        (entry("viscous", {}, joints=[1]), "effect[0].parameters.viscous_N_m_s is missing"),
        (
            entry("viscous", {"viscous_N_m_s": True}, joints=[1]),
            "effect[0].parameters.viscous_N_m_s is True, expected a number from -1000 to 1000",
        ),
        (entry("viscous", {"viscous_N_m_s": "1"}, joints=[1]), "is '1', expected a number from -1000 to 1000"),
        (entry("viscous", {"viscous_N_m_s": np.nan}, joints=[1]), "is nan, expected a number from -1000 to 1000"),
        (entry("backlash", {"gap_rad": -0.1}, joints=[1]), "gap_rad is -0.1, expected a number from 0 to 1"),
        (
            entry("backlash", {"gap_m": 0.1, "gap_rad": 0.1}, joints=[1]),
            "effect[0].parameters.gap_m is not known, expected gap_rad; did you mean 'gap_rad'?",
        ),
        (entry("time_skew", {"delay_s": 0.1}, sensors=["s9"]), "sensors has 's9', expected one of s1, s4"),
        (entry("time_skew", {"delay_s": 0.1}), "effect[0].sensors is missing: time_skew acts on sensors"),
        (
            entry("time_skew", {"delay_s": 0.1}, joints=[1], sensors=["s1"]),
            "effect[0].joints is [1], but time_skew acts on sensors",
        ),
        (entry("payload", {"mass_kg": 0.1}, joints=[2]), "but payload acts on the arm as a whole"),
        (
            entry("payload", {"mass_kg": 0.1, "trials": 2}),
            "trials is 2, expected a list of whole numbers from 1 to",
        ),
        (entry("payload", {"mass_kg": 0.1, "trials": [1, 0]}), "trials is [1, 0], expected a list of whole"),
        (entry("payload", {"mass_kg": 0.1, "trials": [1.5]}), "trials is [1.5], expected a list of whole"),
        (entry("payload", {"mass_kg": 0.1, "trials": [True]}), "trials is [True], expected a list of whole"),
        (entry("label_swap", markers=["A"]), "effect[0].markers is ['A']: label_swap acts on 2 markers at once"),
        (entry("label_swap", markers=["A", "C"]), "effect[0].markers has 'C', expected one of A, B"),
    ],
)
def test_a_mistake_is_a_sentence(effect, sentence):
    (found,) = mistakes(effect)
    assert found.startswith("effect[0]") and sentence in found


def test_an_arm_without_sensors_has_none_to_name():
    (found,) = mistakes_in([entry("time_skew", {"delay_s": 0.1}, sensors=["s1"])], 1, [])
    assert found == "effect[0].sensors has 's1', expected one of no sensor"


def test_a_joint_has_one_drive_of_a_kind():
    gain = {"factor": 0.5}
    found = mistakes(entry("gain_error", gain, joints=[1]), entry("gain_error", gain, joints=[2, 1]))
    assert found == ["effect[1]: joint 1 has the effect gain_error already"]
    play = entry("backlash", {"gap_rad": 0.1}, joints=[1])
    assert mistakes(play, play) == ["effect[1]: joint 1 has the effect backlash already"]
    assert (
        mistakes(entry("gain_error", gain, joints=[1]), entry("actuator_delay", {"delay_s": 0.1}, joints=[1]))
        == []
    )
    assert mistakes(*[entry("viscous", {"viscous_N_m_s": 0.1}, joints=[1])] * 2) == []


@pytest.mark.parametrize(
    "effect",
    [
        {"name": 3},
        {},
        entry("viscous", 4, joints=[1]),
        entry("viscous", {"viscous_N_m_s": 1}, joints=["1"]),
        entry("viscous", {"viscous_N_m_s": 1}, joints=[True]),
        entry("time_skew", {"delay_s": 0.1}, sensors=[7]),
    ],
)
def test_what_has_the_wrong_type_is_passed_over(effect):
    assert mistakes({**effect, "parameters": effect.get("parameters") or 4}) == []


def test_one_mistake_does_not_hide_the_next():
    found = mistakes({"name": 3}, entry("magic"), entry("viscous", {"viscuos": 1}, joints=[5]))
    assert [one.split(" ")[0] for one in found] == [
        "effect[1].name",
        "effect[2].joints",
        "effect[2].parameters.viscuos",
        "effect[2].parameters.viscous_N_m_s",
    ]


def test_a_file_without_joints_is_not_blamed_for_them():
    assert mistakes(entry("viscous", {"viscous_N_m_s": 1}, joints=[5]), n_joint=0) == []


def test_numbers_of_numpy_are_numbers():
    numbers = {"mass_kg": np.float32(0.5), "trials": np.array([1, 3])}
    on = (np.int64(2),)
    assert mistakes(entry("payload", numbers), entry("viscous", {"viscous_N_m_s": np.int64(2)}, joints=on)) == []


def test_an_arms_own_joints_sensors_and_markers_count(arm):
    marked = replace(arm, markers=(Marker("A", 1), Marker("B", 2)))
    right = (
        Effect("viscous", {"viscous_N_m_s": 0.1}, (3,)),
        Effect("time_skew", {"delay_s": 0.1}, (), ("s6",)),
        Effect("label_swap", {}, markers=("A", "B")),
    )
    assert effect_mistakes(replace(marked, effects=right)) == []
    wrong = (Effect("magic"), Effect("viscous", {"viscous_N_m_s": 0.1}, (4,)))
    assert len(effect_mistakes(replace(marked, effects=wrong))) == 2


def test_effects_that_the_catalogue_has_not_are_named(arm):
    wrong = replace(arm, effects=(Effect("magic"), Effect("viscous", {"viscous_N_m_s": 0.1}, (4,))))
    with pytest.raises(ConfigError) as caught:
        simulate(wrong, np.zeros((2, 3)), 1e-3, np.zeros(3))
    assert len(caught.value.mistakes) == 2
    assert caught.value.mistakes[1] == "effect[1].joints has 4, expected 1 to 3"
