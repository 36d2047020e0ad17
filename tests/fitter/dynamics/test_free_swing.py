"""A lower leg that swings freely, simulated by scipy: ratios with an elastic knee and without."""

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from arm.model import Arm, Joint
from fitter.data.trial import undriven
from fitter.data.trials import load_trials
from fitter.dynamics.free_swing import swing_corner_hz, swing_ratios, swing_scale
from limbcal.errors import NotIdentifiable

#: m g l / I [1/s^2], viscous and dry friction over I; stiffness of the knee over I and where it rests.
GRAVITY, DAMPING, DRY, STIFFNESS, RESTS_RAD = 33.1, 0.35, 0.3, 4.0, 0.1
STANDARD_GRAVITY_M_S2 = 9.80665
LEG = Arm("leg", (Joint(a_m=0.4),), (STANDARD_GRAVITY_M_S2, 0.0, 0.0))


#: Tissue that stiffens towards 0.9 rad: its moment there over I [1/s^2], and its rate [1/rad].
TISSUE, RATE_1_RAD, END_RAD = 6.0, 8.0, 0.9


def swings(folder, stiffness, seed, noise_rad=2e-3, tissue=0.0):
    """Write four swings at 100 Hz from half a radian and more; return them as trials."""
    rng, t = np.random.default_rng(seed), np.arange(0.0, 6.0, 0.01)

    def moved(_t, y):
        pull = GRAVITY * np.sin(y[0]) + stiffness * (y[0] - RESTS_RAD)
        pull += tissue * np.exp(RATE_1_RAD * (y[0] - END_RAD))
        return [y[1], -pull - DAMPING * y[1] - DRY * np.tanh(y[1] / 1e-3)]

    for k in range(4):
        begun = [rng.uniform(0.6, 1.2) * (-1) ** k, 0.0]
        q = solve_ivp(moved, (0.0, 6.0), begun, t_eval=t, rtol=1e-8, atol=1e-9, max_step=5e-3).y[0]
        rows = np.column_stack([t, q + noise_rad * rng.standard_normal(len(t))])
        np.savetxt(folder / f"swing{k}.csv", rows, delimiter=",", header="t,q1", comments="")
    corner_hz = swing_corner_hz(load_trials([folder], 1, None, arm=LEG))
    return [undriven(trial) for trial in load_trials([folder], 1, None, cutoff_hz=corner_hz, arm=LEG)]


def ratios(trials):
    return {one.name: one for one in swing_ratios(LEG, trials).ratios}


@pytest.mark.parametrize("seed", range(3))
def test_ratios_that_allow_for_a_spring_hold_the_truth(tmp_path, seed):
    found = ratios(swings(tmp_path, STIFFNESS, seed))
    for name, truth in (
        ("(m1*sx1)/I1", GRAVITY / STANDARD_GRAVITY_M_S2),
        ("(D1)/I1", DAMPING),
        ("(fc1)/I1", DRY),
        ("(K1)/I1", STIFFNESS),
    ):
        sprung = found[name].sprung
        assert abs(sprung.value - truth) < 3.5 * sprung.std, name
    assert found["(K1)/I1"].is_significant
    rigid = found["(m1*sx1)/I1"].rigid
    assert rigid.value - GRAVITY / STANDARD_GRAVITY_M_S2 > 10.0 * rigid.std  # gravity takes the spring up


@pytest.mark.parametrize("seed", range(2))
def test_without_a_spring_both_hold_and_the_rigid_one_is_surer(tmp_path, seed):
    found = ratios(swings(tmp_path, 0.0, seed))["(m1*sx1)/I1"]
    for one in (found.rigid, found.sprung):
        assert abs(one.value - GRAVITY / STANDARD_GRAVITY_M_S2) < 3.5 * one.std
    assert found.rigid.std < 0.2 * found.sprung.std


@pytest.mark.parametrize("seed", range(2))
def test_tissue_at_the_end_of_the_range_is_allowed_for(tmp_path, seed):
    swing = swing_ratios(LEG, swings(tmp_path, STIFFNESS, seed, tissue=TISSUE))
    (end,) = swing.ends
    assert (end.joint, end.side) == (0, 1.0) and 0.7 < end.angle_rad < 1.3
    found = {one.name: one for one in swing.ratios}
    for name, truth in (("(m1*sx1)/I1", GRAVITY / STANDARD_GRAVITY_M_S2), ("(K1)/I1", STIFFNESS)):
        one = found[name]
        assert abs(one.honest.value - truth) < 3.5 * one.honest.std, name
        assert abs(one.sprung.value - truth) > 4.0 * one.sprung.std, name  # a spring alone cannot be it
    assert swing.document()["ratios"][0]["with_tissue"] is not None


@pytest.mark.parametrize("stiffness", [0.0, STIFFNESS])
def test_no_end_stiffens_where_there_is_no_tissue(tmp_path, stiffness):
    swing = swing_ratios(LEG, swings(tmp_path, stiffness, 3))
    assert swing.ends == () and swing.document()["ratios"][0]["with_tissue"] is None


def test_the_document_has_both_intervals(tmp_path):
    first = ratios(swings(tmp_path, STIFFNESS, 5))["(K1)/I1"].document()
    assert first["without_springs"] is None
    low, high = first["with_springs"]["ci95"]
    assert low < first["with_springs"]["value"] < high
    assert first["unit"] == "N m/rad / (kg m^2)"


def test_the_scale_is_the_arm_files_or_one():
    assert swing_scale(LEG) == {"I1": 1.0}
    with pytest.raises(NotIdentifiable, match="no joint turns"):
        swing_scale(Arm("slide", (Joint(type="prismatic"),)))
