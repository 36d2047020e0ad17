"""A simulation under the arm's control law as something to play."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from arm.effects.trials import TrialId
from arm.model import Arm, Control, Effect
from arm.simulation import GearedMotion, simulate
from limbcal.errors import ConfigError, DataError
from playback.simulated_source import simulated_source

DT_S = 1e-3


@pytest.fixture
def reference(tmp_path: Path) -> Path:
    """Two trials of targets, stepped after a tenth of a second; time printed with few digits."""
    rows = ["t,ref1,ref2,trial"]
    for trial in (4, 7):
        for k in range(501):
            rows.append(f"{k * DT_S:.4f},{0.1 * trial * (k > 100)},{-0.2 * (k > 100)},{trial}")
    path = tmp_path / "reference.csv"
    path.write_text("\n".join(rows) + "\n", encoding="utf-8")
    return path


def targets(trial: int) -> np.ndarray:
    return np.outer(np.arange(501) > 100, [0.1 * trial, -0.2])


def test_it_plays_the_links_of_an_arm_that_twists(reference: Path, arm: Arm) -> None:
    spring = Effect("joint_elasticity", {"stiffness_N_m_rad": 20.0, "damping_N_m_s": 0.5}, (2,))
    twisting = replace(arm, control=replace(arm.control, law="pd"), effects=(spring,))
    known = simulate(twisting, targets(4), DT_S, np.zeros(2))
    assert isinstance(known, GearedMotion) and np.abs(known.q - known.link_q).max() > 1e-3
    np.testing.assert_array_equal(simulated_source(reference, twisting).load(4).q, known.link_q)


def test_it_plays_what_the_simulation_gives(reference: Path, arm: Arm) -> None:
    source = simulated_source(reference, arm)
    assert source.durations_s == {4: 0.5, 7: 0.5}
    assert source.name == "simulation of dd-arm following reference.csv"
    for trial in (7, 4):
        motion, known = source.load(trial), simulate(arm, targets(trial), DT_S, np.zeros(2))
        assert motion.method == "simulate"
        np.testing.assert_allclose(motion.t, known.t, atol=1e-12)
        for name in ("q", "dq", "ddq"):
            np.testing.assert_allclose(getattr(motion, name), getattr(known, name), atol=1e-9)
        assert np.ptp(motion.q, axis=0).min() > 0.05  # it does move


def test_it_starts_where_the_file_says(tmp_path: Path, arm: Arm) -> None:
    path = tmp_path / "started.npz"
    t, ones = np.arange(20) * DT_S, np.ones(20)
    np.savez(path, t=t, ref1=ones, ref2=ones, q1=0.3 * ones, q2=0.4 * ones, dq1=0.5 * ones, dq2=-ones)
    motion = simulated_source(path, arm).load()
    np.testing.assert_array_equal(motion.q[0], [0.3, 0.4])
    np.testing.assert_array_equal(motion.dq[0], [0.5, -1.0])
    np.savez(path, t=t, ref1=ones, ref2=2 * ones)
    motion = simulated_source(path, arm).load()
    np.testing.assert_array_equal(motion.q[0], [1.0, 2.0])


def test_an_effect_acts_by_the_clock_and_trial_of_the_file(tmp_path: Path, arm: Arm) -> None:
    push = Effect("external_push", {"start_s": 10.1003, "duration_s": 0.1, "torque_N_m": 3.0}, (1,))
    load = Effect("payload", {"mass_kg": 2.0, "trials": ["run/b"]})
    acted = replace(arm, effects=(push, load))
    path, t, labels = tmp_path / "run.npz", np.arange(400) * DT_S, np.repeat(["a", "b"], 400)
    np.savez(path, t=np.tile(10.0 + t, 2), ref1=np.full(800, 0.4), ref2=np.zeros(800), trial=labels)
    ref = np.tile([0.4, 0.0], (400, 1))
    source, unmoved = simulated_source(path, acted), simulated_source(path, arm)
    for number in (1, 2):
        called = TrialId(number, f"run/{'ab'[number - 1]}")
        known = simulate(acted, ref, DT_S, ref[0], t0_s=10.0, trial=called)
        np.testing.assert_allclose(source.load(number).q, known.q, atol=1e-9)
        assert np.abs(known.q - unmoved.load(number).q).max() > 1e-3
    assert np.abs(source.load(1).q - source.load(2).q).max() > 1e-4  # only the second carries something


def test_a_drive_of_the_file_that_is_let_go_gives_no_torque(tmp_path: Path, arm: Arm) -> None:
    path, n = tmp_path / "let_go.npz", 100
    columns = {"ref1": np.full(n, 0.5), "ref2": np.zeros(n), "q1": np.zeros(n), "q2": np.zeros(n)}
    np.savez(path, t=np.arange(n) * DT_S, **columns, on1=np.zeros(n), on2=np.ones(n))
    assert np.ptp(simulated_source(path, arm).load().q) < 1e-12
    np.savez(path, t=np.arange(n) * DT_S, **columns, on1=np.full(n, 0.5), on2=np.ones(n))
    with pytest.raises(DataError, match="on1 in row 1 is 0.5, expected 1 where the drive is engaged"):
        simulated_source(path, arm)


def test_a_sample_left_out_is_refused(reference: Path, arm: Arm) -> None:
    lines = reference.read_text(encoding="utf-8").splitlines()
    del lines[250]
    reference.write_text("\n".join(lines) + "\n", encoding="utf-8")
    with pytest.raises(DataError, match="trial 4: sample 250 is .* expected evenly spaced time"):
        simulated_source(reference, arm)


def test_an_arm_that_cannot_be_simulated_is_refused(reference: Path, arm: Arm) -> None:
    with pytest.raises(ConfigError, match="control law is 'measured'"):
        simulated_source(reference, replace(arm, control=Control()))
    with pytest.raises(DataError, match="there is a column 'ref2', but the arm has 1 joint"):
        simulated_source(reference, replace(arm, joints=arm.joints[:1]))


def test_an_arm_that_runs_away_is_refused_when_loaded(reference: Path, arm: Arm) -> None:
    pushing = replace(arm, control=Control("pd", kp=(-1e9, -1e9), kv=(1e9, 1e9)))
    source = simulated_source(reference, pushing)
    with pytest.raises(DataError, match=r"trial 4: .* runs away to infinity: control.kp\[0\] is -1e\+09"):
        source.load(4)
