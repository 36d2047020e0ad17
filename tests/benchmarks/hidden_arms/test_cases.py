"""The cases themselves: repeatable, of the right size, as the definitions say, and without the truth."""

from functools import cache
from pathlib import Path

import numpy as np
import pytest

from arm.arm_file import load_arm
from benchmarks.hidden_arms.arms import draw_scene
from benchmarks.hidden_arms.cases import ANGLE_NOISE_RAD, Case, draw_case
from benchmarks.hidden_arms.effects import EFFECTS, joints_for
from benchmarks.hidden_arms.hidden_arm import LENGTH
from benchmarks.hidden_arms.hiding import Bench, Hiding, Scene
from benchmarks.hidden_arms.oracle import Known, Set, left_by_oracle, true_effects
from benchmarks.hidden_arms.simulation import simulate
from benchmarks.hidden_arms.unexplained import columns, fit, rms

SHORT = Bench(trial_s=3.0, learning=3, evaluating=3)


def hidden(effect: str) -> tuple[Scene, Hiding, float]:
    """Return a scene in which an effect can be seen, and a visible strength of it, not searched for."""
    rng = np.random.default_rng(42)
    while True:
        scene = draw_scene(rng, SHORT, [effect])
        if scene is not None:
            hiding = EFFECTS[effect](rng, scene, joints_for(effect, scene)[-1])
            return scene, hiding, min(2.0 * hiding.start, hiding.most)


@cache
def short_case(seed: int, effect: str) -> Case:
    return draw_case(seed, "one", effect, SHORT)


def test_the_same_seed_gives_the_same_case() -> None:
    one, again = short_case(7, "gain_error"), draw_case(7, "one", "gain_error", SHORT)
    assert one.truth == again.truth
    assert one.truth["arm"] != short_case(46, "joint_spring").truth["arm"]
    np.testing.assert_array_equal(one.tau, again.tau)


def test_the_truth_is_not_handed_out(tmp_path: Path) -> None:
    case = short_case(7, "gain_error")
    learn, evaluate, arm = case.write(tmp_path)
    assert {path.name for path in tmp_path.iterdir()} == {"learn.npz", "evaluate.npz", "arm.toml"}
    given = load_arm(arm)
    assert not given.effects
    for joint, link in zip(given.joints, case.hidden.links, strict=True):
        assert joint.a_m == link[LENGTH]
        assert joint.link.mass_kg == 1.0
        assert not any(vars(joint.friction).values())
    with np.load(learn) as first, np.load(evaluate) as second:
        n = given.n_joint
        names = {"t", "trial", *(f"{name}{i + 1}" for name in ("q", "tau", "ref") for i in range(n))}
        assert set(first.files) == set(second.files) == names
        assert second["t"][0] == pytest.approx(first["t"][-1] + 1.0 / SHORT.rate_hz)
        assert set(first["trial"]) == {1, 2, 3} and set(second["trial"]) == {4, 5, 6}
    off = case.q - case.recorded.q
    assert np.std(off) == pytest.approx(ANGLE_NOISE_RAD, rel=0.05)


@pytest.mark.parametrize("effect", EFFECTS)
def test_an_effect_is_hidden_as_it_is_defined(effect: str) -> None:
    """What the definitions say of the torque explains most of what a base model leaves, without noise."""
    scene, hiding, strength = hidden(effect)
    motion = simulate(hiding.hide(scene.arm, strength), scene.ref, SHORT.rate_hz, SHORT.trial_s)
    trial = np.repeat(np.arange(SHORT.trials) + 1, round(SHORT.trial_s * SHORT.rate_hz))
    learning = trial <= SHORT.learning
    learn, evaluate = (
        Set(motion.t[rows], trial[rows], motion.q[rows], motion.u[rows], motion.ref[rows], SHORT.rate_hz)
        for rows in (learning, ~learning)
    )
    known = Known(scene.arm.links[:, LENGTH], scene.arm.gravity, 1e-3 * scene.torque)
    joints = [i + 1 for i in hiding.joints]
    truth = {
        "effects": [{"effect": effect, "joints": joints, "entries": hiding.entries(strength)}],
        "arm": {"friction": scene.arm.friction.tolist()},
    }
    judged = learn if hiding.learning_only else evaluate
    without = left_by_oracle(known, learn, judged, [])
    with_it = left_by_oracle(known, learn, judged, true_effects(truth))
    own = list(hiding.joints) or slice(None)
    if effect == "stiction":
        np.testing.assert_allclose(with_it, without)  # it is no torque of a joint that moves
    elif effect in ("joint_zero", "gain_error"):
        assert np.min(with_it / without) < 0.1, with_it / without  # they show at other joints than their own
    else:
        most = 0.9 if effect == "backlash" else 0.5  # how a motor crosses its play nobody sees
        assert np.max((with_it / without)[own]) < most


@pytest.mark.parametrize("effect", ["joint_spring", "torque_saturation"])
def test_a_case_is_of_the_right_size(effect: str) -> None:
    case = short_case(46, effect)
    hidden_at = [joint - 1 for joint in case.truth["effects"][0]["joints"]]
    known = case.hidden.links[:, LENGTH], case.hidden.gravity
    Y = columns(*known, case.recorded.link_q, case.recorded.link_dq, case.recorded.link_ddq)
    used = case.recorded.link_dq != 0.0
    left = rms(case.recorded.u - Y @ fit(Y, case.recorded.u, used), used) / rms(case.recorded.u, used)
    assert 0.039 < left[hidden_at].max() < 0.151


def test_where_an_effect_holds_the_arm_still_less_of_it_is_hidden() -> None:
    """With the first limit that is tried, friction holds this arm's only joint all the time."""
    (effect,) = draw_case(440035, "one", "torque_saturation").truth["effects"]
    assert 0.04 < effect["unexplained"] < 0.15
