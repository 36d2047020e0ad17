"""Ratios of a limb whose law's gains and equilibrium trajectory nobody knows."""

import numpy as np
import pytest

from arm.arm_file import load_arm
from arm.model import Arm, Joint
from fitter.controller.equilibrium_ratios import equilibrium_ratios
from fitter.data.motions import Measured
from fitter.data.trials import to_trials
from limbcal.errors import NotIdentifiable
from tests.fitter.held_limb import KP, KV_LOOSE, limb, moved, released

INERTIA, MOMENT, DAMPING = 0.05, 1.5 * 0.15, 0.1


@pytest.mark.parametrize("seed", range(2))
def test_a_quick_release_tells_the_ratios(tmp_path, seed):
    fit = equilibrium_ratios(limb(KV_LOOSE), released(tmp_path, seed))
    found = {one.name: one.ci95 for one in fit.ratios}
    truth = {"m1*sx1": MOMENT, "m1*sy1": 0.0, "D1-kv1": DAMPING - KV_LOOSE, "kp1": KP}
    for name, value in truth.items():
        low, high = found[f"({name})/I1"]
        assert low - 0.2 * (high - low) < value / INERTIA < high + 0.2 * (high - low), name
    low, high = found["(kp1)/I1"]
    assert high - low < 0.3 * KP / INERTIA
    low, high = found["(kp1 and gravity)/I1"]  # a spring and gravity are identified together better than apart
    assert high - low < 0.1 * KP / INERTIA
    assert 0.3 < fit.bandwidth_hz < 3.0


def test_a_motion_at_will_tells_nothing_and_says_so(tmp_path):
    fit = equilibrium_ratios(limb(-1.5), moved(tmp_path))
    assert not fit.known
    document = fit.document()
    assert document["up_to_scale"] is True
    assert all(one["value"] is None and one["ci95"] is None for one in document["ratios"])
    assert any("no ratio" in sentence for sentence in document["sentences"])


def test_the_same_seed_gives_the_same_ratios(tmp_path):
    trials = released(tmp_path)
    first, second = (equilibrium_ratios(limb(KV_LOOSE), trials, seed=3).document() for _ in range(2))
    assert first == second


def test_an_arm_that_only_slides_has_no_inertia(tmp_path):
    with pytest.raises(NotIdentifiable, match="no joint turns"):
        equilibrium_ratios(Arm("slide", (Joint(type="prismatic"),)), released(tmp_path))


def test_a_whole_arm_that_no_law_holds_tells_nothing():
    """Sines in every joint obey no law with a slow trajectory."""
    arm = load_arm("human-arm-right")
    t = np.arange(0.0, 4.0, 0.01)
    rng = np.random.default_rng(0)
    q = 0.3 * np.sin(np.outer(t, rng.uniform(2.0, 5.0, arm.n_joint))) + 1e-3 * rng.normal(
        size=(len(t), arm.n_joint)
    )
    fit = equilibrium_ratios(arm, to_trials([Measured("sway", "test", 0, t, {"q": q})]))
    assert fit.document()["up_to_scale"] is True and not fit.known
