"""What the benchmark of hidden pulses asks for, and what it takes for found."""

import numpy as np
import pytest

from benchmarks.pulses import Push, Score, hidden_in, named_in


def push(start_s=1.0, torque_N_m=0.5, joint=1, run="swing"):
    return Push(run, joint, start_s, 0.2, torque_N_m)


def test_hidden_pulses_are_those_of_the_columns(tmp_path):
    t = np.arange(0.0, 4.0, 0.002)
    bump = 0.6 * np.sin(np.pi * (t - 1.0) / 0.3) * ((t > 1.0) & (t < 1.3))
    table = np.stack([t, bump, -bump], axis=1)
    path = tmp_path / "swing.csv"
    np.savetxt(path, table, delimiter=",", header="time,tau_pert1,tau_pert2", comments="")
    pushes, lasts_s = hidden_in(path)
    assert lasts_s == pytest.approx(4.0, abs=0.01)
    assert [(one.run, one.joint) for one in pushes] == [("swing", 1), ("swing", 2)]
    for one, sign in zip(pushes, (1.0, -1.0), strict=True):
        numbers = one.start_s, one.duration_s, one.torque_N_m
        assert numbers == pytest.approx((1.05, 0.2, 0.6 * sign), abs=0.005)  # at half its height


def test_named_pushes_are_those_of_the_document():
    numbers = {"start_s": 1.0, "duration_s": 0.2, "torque_N_m": 0.5, "trial": "swing"}
    parameters = {name: {"value": value} for name, value in numbers.items()}
    causes = [{"effect": "external_push", "joints": [1], "parameters": parameters}]
    causes += [{"effect": "stribeck", "joints": [2], "parameters": {}}]
    assert named_in({"causes": causes}) == [push()]


@pytest.mark.parametrize(
    ("named", "found", "false"),
    [
        (push(1.04, 0.6), 1, 0),
        (push(1.06, 0.5), 0, 0),
        (push(1.0, 0.3), 0, 0),
        (push(1.0, -0.5), 0, 0),
        (push(joint=2), 0, 1),
        (push(run="other"), 0, 1),
        (push(2.0), 0, 1),
    ],
)
def test_a_push_is_found_at_its_joint_and_time_with_its_size(named, found, false):
    score = Score.of([push()], [named], 10.0)
    assert (len(score.asked), len(score.found), len(score.false)) == (1, found, false)


def test_a_small_pulse_is_not_asked_for_and_not_false():
    score = Score.of([push(torque_N_m=0.2)], [push(torque_N_m=0.2)], 10.0)
    assert (score.asked, score.false) == ([], [])
