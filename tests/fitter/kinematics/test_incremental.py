"""The search for a geometry while frames come in."""

import pickle

import numpy as np
import pytest

from arm.arm_file import load_arm
from fitter.data.first_rest import displacement
from fitter.kinematics.incremental import IncrementalKinematics
from fitter.kinematics.tip_basis import geometry_of, with_geometry
from limbcal.errors import ConfigError

ARM = load_arm("dd-arm")
PRIOR = with_geometry(ARM, np.array([[0.0, 0.4, 0.0, 0.0, 0.1], [0.0, 0.5, 0.0, 0.0, -0.1]]))


def stream(search, trials, block=5, every=1):
    for number, trial in enumerate(trials):
        moved, rest = displacement(ARM, trial)
        for start in range(0, len(trial.t), block):
            part = slice(start, start + block)
            search.add(trial.q[part], moved[part], rest, number)
            if start % every == 0:
                search.generation()


def test_converges_while_frames_come_in(bench_trials):
    search = IncrementalKinematics(PRIOR, 0)
    stream(search, bench_trials[:2])
    assert np.allclose(search.best, geometry_of(ARM), atol=1e-6)
    assert search.samples == 2 * len(bench_trials[0].t)
    assert search.tip_rms_m < 1e-6


def test_nothing_is_told_before_anything_moves(bench_trials):
    search = IncrementalKinematics(PRIOR, 0)
    assert np.isnan(search.generation())
    rest = bench_trials[0].q[:100]
    noise = np.random.default_rng(0).normal(size=(2, 100, 3))
    search.add(rest + 1e-4 * noise[0, :, :2], 1e-4 * noise[1], rest)
    for _ in range(30):
        search.generation()
    assert not np.any(search.is_determined)
    assert search.generations == 0
    assert np.array_equal(search.best, geometry_of(PRIOR))


def test_one_joint_tells_its_own_link_only(bench_trials):
    """While joint 2 rests only the distance and direction from axis 1 to the tip can be seen."""
    q = np.zeros((200, 2))
    q[:, 0] = np.linspace(0.0, 1.0, 200)
    tip = 0.55 * np.column_stack([np.cos(q[:, 0]), np.sin(q[:, 0]), np.zeros(200)])
    search = IncrementalKinematics(with_geometry(ARM, geometry_of(PRIOR) * [1, 1, 1, 1, 0]), 0)
    search.add(q, tip - tip[0], q[0])
    for _ in range(200):
        search.generation()
    assert 0 < np.count_nonzero(search.is_determined) < 5
    assert search.tip_rms_m < 1e-8
    for number, trial in enumerate(bench_trials[:2], start=1):  # and then joint 2 moves
        moved, rest = displacement(ARM, trial)
        search.add(trial.q, moved, rest, number)
    for _ in range(400):
        search.generation()
    assert np.allclose(search.best, geometry_of(ARM), atol=1e-6)


def test_small_blocks_give_the_sums_and_errors_of_large_ones(bench_trials):
    noise = 1e-3 * np.random.default_rng(0).normal(size=bench_trials[0].tip.shape)
    found = []
    for block in (7, 100, 5000):
        search = IncrementalKinematics(PRIOR, 0)
        for number, trial in enumerate(bench_trials[:3]):
            moved, rest = displacement(ARM, trial)
            for start in range(0, len(trial.t), block):
                part = slice(start, start + block)
                search.add(trial.q[part], (moved + noise)[part], rest, number)
        for _ in range(300):
            search.generation()
        found.append((search.best, np.sqrt(np.diag(search.scattered()))))
    for best, std in found[1:]:
        assert np.allclose(best, found[0][0], atol=1e-7)
        assert np.allclose(std, found[0][1], rtol=0.3)
    assert search.promise() < 1e-6


def test_what_a_generation_works_on_does_not_grow_with_the_frames(bench_trials):
    held_bytes = []
    for repeat in (1, 20):
        search = IncrementalKinematics(PRIOR, 0)
        for number in range(repeat):
            trial = bench_trials[number % 4]
            moved, rest = displacement(ARM, trial)
            search.add(trial.q, moved, rest, number)
        search._parts.clear()  # only the standard errors ask for them
        search.generation()
        held_bytes.append(len(pickle.dumps(search)))
    assert held_bytes[1] < 1.2 * held_bytes[0]  # twenty times the frames


def test_restricted_conditions(bench_trials):
    search = IncrementalKinematics(PRIOR, 0, fixed={"a1": 0.25}, bounds={"a2": (0.35, 0.6)}, free=["beta1"])
    stream(search, bench_trials[:1])
    assert search.best[0, 1] == 0.25
    assert search.best[1, 1] >= 0.35
    assert search.is_determined[0, 3]
    with pytest.raises(ConfigError, match="no geometric parameter is called a3"):
        IncrementalKinematics(PRIOR, 0, fixed={"a3": 0.0})
    with pytest.raises(ConfigError, match="bounds of a1"):
        IncrementalKinematics(PRIOR, 0, bounds={"a1": (1.0, 0.0)})
