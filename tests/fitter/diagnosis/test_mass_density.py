"""The density of a motion: its slopes, its scale, and what is no mass."""

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from arm.effects.catalogue import catalogue
from fitter.diagnosis.arm_hypotheses import RotorInertia
from fitter.diagnosis.error_floor import regression_of
from fitter.diagnosis.joint_hypotheses import JointHypothesis
from fitter.diagnosis.least_squares import Normal
from fitter.diagnosis.mass_density import CURVATURE_NUMBERS, MassDensity
from fitter.diagnosis.model import Model
from fitter.diagnosis.static_friction import HeldStribeck
from tests.fitter.diagnosis.searched import swinging
from tests.fitter.diagnosis.two_joints import regression_of_two

WEIGHT = 0.5
#: A model of the base parameters, and one with a column that is a mass.
MODELS = {"base": Model(), "rotor": Model().plus(RotorInertia(catalogue()["rotor_inertia"], (1,)), np.zeros(0))}


def density_of(regression, weight=WEIGHT):
    n_effective = {
        motion.number: regression.weighting.n_effective_at_joints(motion) for motion in regression.motions
    }
    start = regression.solve(Model(), regression.motions)
    return MassDensity(regression.equations, regression.motions, weight, n_effective, start)


@pytest.fixture(scope="module")
def regression():
    """Return a run in which nothing is stuck: a stuck joint has a mass of one."""
    plain = regression_of_two(trials=2)
    motions = [replace(one, stuck=np.zeros_like(one.stuck)) for one in plain.motions]
    return regression_of(plain.arm, motions)


@pytest.fixture(scope="module")
def density(regression):
    return density_of(regression)


@pytest.mark.parametrize("name", MODELS)
def test_slopes_are_those_of_the_density(regression, density, name):
    model, motions = MODELS[name], regression.motions
    x = regression.solve(model, motions)
    score, information = density.slopes(model, x, motions)
    for k in range(len(x)):
        step = 1e-4 * max(abs(float(x[k])), 0.1) * (np.arange(len(x)) == k)
        ahead, behind = (density.of(model, x + s, motions) for s in (step, -step))
        assert score[k] == pytest.approx((ahead - behind) / (2.0 * step[k]), rel=1e-4, abs=1e-4)
        ahead, behind = (density.slopes(model, x + s, motions)[0] for s in (step, -step))
        bend = -(ahead - behind) / (2.0 * step[k])
        np.testing.assert_allclose(information[k], bend, rtol=1e-3, atol=1e-4 * np.abs(information).max())
    assert np.linalg.eigvalsh(information).min() > -1e-6 * np.abs(information).max()


@given(st.floats(0.1, 10.0))
@settings(max_examples=10, deadline=None)
def test_twice_the_masses_add_log_2_for_each_number_that_is_told(regression, density, factor):
    motions = regression.motions
    x = regression.solve(Model(), motions)
    numbers = sum(regression.weighting.n_effective(motion) for motion in motions)
    more = density.of(Model(), factor * x, motions) - density.of(Model(), x, motions)
    assert more == pytest.approx(WEIGHT * numbers * np.log(factor), rel=1e-6, abs=1e-6)


def test_what_is_no_mass_is_impossible(regression, density):
    x = regression.solve(Model(), regression.motions)
    assert density.of(Model(), -x, regression.motions) == -np.inf
    assert density.of(Model(), 0.0 * x, regression.motions) == -np.inf


def normal_equations(regression, model):
    rows = [regression.rows(model, motion) for motion in regression.motions]
    square = sum(float(one.right.gram[0, 0]) for one in rows)
    return Normal(sum(one.columns.gram for one in rows), sum(one.rhs for one in rows), square)


@pytest.mark.parametrize("begun", [1.0, 0.5, -1.0])
def test_the_likeliest_factors_have_no_slope_left_wherever_they_are_begun(regression, density, begun):
    """From masses that are none, it is begun with those that are some."""
    motions = regression.motions
    normal, numbers = normal_equations(regression, Model()), float(regression.n_effective.sum())
    plain = regression.solve(Model(), motions)
    x = density.solve(normal, numbers, begun * plain, Model(), motions)
    score, information = density.slopes(Model(), x, motions)
    weight = numbers / normal.sum_of_squares(x)
    slope = weight * (normal.rhs - normal.gram @ x) + score
    assert slope @ np.linalg.lstsq(weight * normal.gram + information, slope, rcond=1e-11)[0] < 0.1  # nats, twice


def test_without_weight_least_squares_stay_what_they_are(regression):
    normal = normal_equations(regression, Model())
    plain = np.linalg.lstsq(normal.gram, normal.rhs, rcond=None)[0]
    numbers = float(regression.n_effective.sum())
    x = density_of(regression, 0.0).solve(normal, numbers, plain, Model(), regression.motions)
    np.testing.assert_allclose(normal.gram @ x, normal.rhs, rtol=1e-6, atol=1e-6 * np.abs(normal.rhs).max())


def test_a_joint_that_is_stuck_has_a_mass_of_one():
    plain = swinging(trials=2)
    held = [replace(one, stuck=np.ones_like(one.stuck)) for one in plain.motions]
    regression = regression_of(plain.arm, [plain.motions[0], *held[1:]])
    density = density_of(regression)
    x = np.array([3.0] * len(plain.solve(Model(), plain.motions)))
    assert density.of(Model(), x, held[1:]) == 0.0


def test_two_forms_of_one_effect_at_one_joint_are_kept_apart():
    regression = swinging(trials=2)
    density, motions, width = density_of(regression), regression.motions, np.array([0.5])
    fitted = Model().plus(JointHypothesis(catalogue()["stribeck"], 0), width)
    given = Model().plus(HeldStribeck(0, 0.1), width)
    values = [density.of(model, regression.solve(model, motions), motions) for model in (Model(), fitted, given)]
    assert np.all(np.isfinite(values))


def test_a_steps_curvature_is_that_of_some_instants_which_weigh_as_much_as_all(regression, density):
    """That of all instants took most of the time of a diagnosis of six joints."""
    x = regression.solve(Model(), regression.motions)
    every = density._masses(Model(), regression.motions)  # noqa: SLF001
    some = every.sparse
    assert some.known[..., 0].size < 2 * CURVATURE_NUMBERS < every.known[..., 0].size
    whole = every.information(x)
    size = np.sqrt(np.diag(whole))
    assert np.all(np.abs(some.information(x) - whole) <= 0.1 * np.outer(size, size))


def test_of_what_was_computed_only_so_much_is_kept_and_the_last_asked_about_longest(regression, monkeypatch):
    motions, kept, made = regression.motions, [], []
    effect = catalogue()["rotor_inertia"]
    models = [Model(), *(Model().plus(RotorInertia(effect, (j,)), np.zeros(0)) for j in range(2))]
    bound = 2.5 * density_of(regression)._masses(Model(), motions).slopes.nbytes  # noqa: SLF001
    density = density_of(regression)
    density._remembered_bytes = bound  # noqa: SLF001
    plain = density._made  # noqa: SLF001
    monkeypatch.setattr(density, "_made", lambda *args: made.append(args) or plain(*args))
    for model in (models[0], models[1], models[0], models[2], models[0]):
        density.of(model, regression.solve(model, motions), motions)
        kept.append(sum(one[0].nbytes for one in density._known.values()))  # noqa: SLF001
    assert max(kept) <= bound
    assert len(made) == 3 * len(motions)
