"""An arm that is calibrated motion after motion."""

from dataclasses import replace

import numpy as np
import pytest

from arm.arm_file import format_arm, parse_arm
from arm.model import Control
from fitter.kinematics.tip_basis import geometry_of
from fitter.live.calibration import GENERATIONS, Calibration
from limbcal.errors import DataError


def breed_all(calibration):
    generations = 0
    while calibration.breed():
        generations += 1
    return generations


def without_rows(motion, rows):
    columns = {name: np.delete(values, rows, axis=0) for name, values in motion.columns.items()}
    return replace(motion, t=np.delete(motion.t, rows), columns=columns)


def test_what_is_learnt_is_the_arm(calibration, short_run):
    assert [len(calibration.learn), len(calibration.evaluate)] == [2, 1]
    assert calibration.learnt and calibration.doubt == ""
    true = geometry_of(short_run.arm)
    assert np.allclose(geometry_of(calibration.kinematics().arm)[:, 1], true[:, 1], atol=2e-3)  # a1, a2 [m]
    values = {name: p.value for name, p in calibration.dynamics.parameters.items()}
    for name, value in (("I1+m2*L1^2", 1.986076), ("m2*sx2", 1.718632), ("I2", 0.471209)):
        assert values[name] == pytest.approx(value, rel=0.01)


def test_the_calibrated_arm_moves_as_the_measured_one(calibration):
    for role in ("learn", "evaluate"):
        moved, reached = calibration.scores(role)
        assert moved.angle_mean_deg < 0.5
        assert reached.mean_mm < 5.0
    assert calibration.scores("learn")[1].mean_mm == pytest.approx(1e3 * calibration.geometry.tip_rms_m, rel=0.5)


def test_the_calibrated_arm_keeps_its_name_and_can_be_written(calibration, short_run):
    arm = calibration.calibrated()
    assert arm.name == short_run.arm.name
    assert arm.sensors == short_run.arm.sensors and arm.control == short_run.arm.control
    assert set(arm.base_parameters) <= set(calibration.dynamics.parameters)
    assert parse_arm(format_arm(arm), "again") == arm


def test_nothing_is_known_before_anything_has_moved(short_run):
    calibration = Calibration(short_run.arm)
    assert not calibration.breed()
    assert calibration.kinematics() is None and calibration.dynamics is None and not calibration.learnt
    assert calibration.calibrated() == short_run.arm
    assert calibration.scores("learn") == calibration.scores("evaluate") == (None, None)
    calibration.learn_dynamics()
    assert calibration.doubt == "no learning trial; expected at least one"


def test_every_learning_motion_is_worth_some_generations(measured, short_run):
    calibration = Calibration(short_run.arm)
    learn, _, evaluate = measured
    calibration.add(learn)
    assert breed_all(calibration) == GENERATIONS
    calibration.add(evaluate)
    assert not calibration.breed()  # what is held back is not learnt from
    assert calibration.geometry.samples == len(calibration.learn[0].t)


def test_geometry_may_be_learnt_without_dynamics(measured, short_run):
    calibration = Calibration(replace(short_run.arm, control=Control("measured")))
    calibration.add(measured[0])
    breed_all(calibration)
    calibration.learn_dynamics()
    assert "has no torque" in calibration.doubt
    assert calibration.dynamics is None and calibration.learnt
    assert calibration.calibrated() == calibration.kinematics().arm
    moved, reached = calibration.scores("learn")
    assert moved is None and reached is not None


def test_dynamics_may_be_learnt_without_a_measured_tip(measured, short_run):
    calibration = Calibration(replace(short_run.arm, tip=None))
    calibration.add(measured[0])
    assert not calibration.breed() and calibration.kinematics() is None
    calibration.learn_dynamics()
    assert calibration.dynamics is not None and calibration.learnt
    moved, reached = calibration.scores("learn")
    assert moved is not None and reached is None


def test_a_later_doubt_keeps_what_was_learnt(calibration, measured, short_run):
    again = Calibration(short_run.arm)
    again.add(measured[0])
    again.learn_dynamics()
    learnt = again.dynamics
    again.learn[0] = replace(again.learn[0], q=again.learn[0].q[:, :1])  # nothing that could happen to a stream
    again.learn_dynamics()
    assert again.doubt != "" and again.dynamics is learnt


@pytest.mark.parametrize("seed", [0, 5])
def test_the_same_seed_gives_the_same_arm_however_fast_the_machine(measured, short_run, seed):
    found = []
    for generations in (3, 100):
        calibration = Calibration(short_run.arm, seed)
        for motion in measured:
            calibration.add(motion)
            for _ in range(generations):
                calibration.breed()
            calibration.kinematics()
        calibration.conclude()
        assert calibration.geometry.generations == GENERATIONS
        found.append(format_arm(calibration.calibrated()))
    assert found[0] == found[1]


def test_the_longest_stretch_is_kept_where_messages_were_missed(measured, short_run):
    calibration = Calibration(short_run.arm)
    n = len(measured[0].t)
    trial = calibration.add(without_rows(measured[0], np.s_[1000:1100]))
    assert len(trial.t) == n - 1100
    assert any("parted at 1 hole" in note.text for note in trial.notes)
    assert len(calibration.learn) == 1


@pytest.mark.parametrize(
    ("change", "said"),
    [
        (lambda m: without_rows(m, np.s_[10:]), "has 10 samples, expected at least 16"),
        (lambda m: replace(m, t=np.r_[m.t[:50], m.t[49:-1]]), "time stands still"),
        (lambda m: with_column(m, "q", m.columns["q"][:, :1]), "frames of 1 joint angles, expected 2"),
        (lambda m: with_column(m, "dq", np.where(m.t[:, None] > 1, np.nan, m.columns["dq"])), "dq holds a value"),
        (lambda m: with_column(m, "points", m.columns["points"][:, :3]), "expected 4 sensors as arm 'dd-arm' has"),
    ],
)
def test_a_motion_that_cannot_be_used_is_refused_and_changes_nothing(measured, short_run, change, said):
    calibration = Calibration(short_run.arm)
    with pytest.raises(DataError, match=said):
        calibration.add(change(measured[0]))
    assert calibration.learn == calibration.evaluate == []
    assert not calibration.breed() and calibration.geometry.samples == 0


def with_column(motion, name, values):
    return replace(motion, columns={**motion.columns, name: values})
