"""What motion under a law can't tell."""

from dataclasses import replace

import numpy as np
import pytest

from arm.arm_file import load_arm
from arm.base_parameters import base_parameters
from arm.model import Arm, Control, Joint, Link
from arm.regressor import standard_parameters
from arm.simulation import simulate
from fitter.controller.law_ambiguity import LawNullSpace
from fitter.controller.law_columns import law_columns, law_rows
from fitter.controller.law_equations import law_equations
from fitter.controller.law_fit import equations_gram
from fitter.data.trial import Trial

ARM = load_arm("dd-arm")


def null_space(arm, trials, law):
    base = base_parameters(arm)
    columns = law_columns(arm, base).narrowed(law)
    gram = equations_gram([law_equations(arm, base, trial) for trial in trials])
    return columns, LawNullSpace(columns, gram)


def groups(columns, ambiguity):
    return [
        {columns.names[k]: round(weight, 9) for k, weight in weights.items()}
        for weights in ambiguity.combinations()
    ]


@pytest.mark.parametrize("targets_known", [True, False])
@pytest.mark.parametrize(
    ("law", "together"),
    [
        ("p", []),
        ("pd", [{"kv1": 1, "D1": -1}, {"kv2": 1, "D2": -1}]),
        ("pda", [{"I1+m2*L1^2": 1, "ka1": -1}, {"kv1": 1, "D1": -1}, {"kv2": 1, "D2": -1}]),
    ],
)
def test_one_factor_and_what_only_shows_together(bench_trials, law, together, targets_known):
    trials = bench_trials[:4] if targets_known else [replace(trial, ref=None) for trial in bench_trials[:4]]
    columns, space = null_space(ARM, trials, law)
    nothing = space.given([])
    assert [columns.names[k] for k in nothing.leaders] == ["kp1"]
    assert nothing.open().all()
    known = space.given([columns.names.index("kp1")])
    assert known.leaders == ()
    assert groups(columns, known) == together
    # These joints never turn back within a trial: their Coulomb friction is part of a target's unknown constant.
    silent = set() if targets_known else {"fc1", "fc2"}
    open_ones = {columns.names[k] for k in np.flatnonzero(known.open())}
    assert open_ones == silent | {name for pair in together for name in pair}


def test_friction_alone_fixes_no_factor_but_with_its_gain_it_does(bench_trials):
    columns, space = null_space(ARM, bench_trials[:4], "pd")
    place = columns.names.index
    assert space.given([place("D1")]).leaders == (place("kp1"),)
    assert space.given([place("D1"), place("kv1")]).leaders == ()
    assert space.given([place("I2")]).leaders == ()


def test_a_zero_fixes_no_factor(bench_trials):
    base = base_parameters(ARM)
    columns = law_columns(ARM, base).narrowed("pd")
    gram = equations_gram([law_equations(ARM, base, trial) for trial in bench_trials[:4]])
    place = columns.names.index("fc1")
    assert LawNullSpace(columns, gram).given([place]).leaders == ()
    assert LawNullSpace(columns, gram, [place]).given([place]).leaders == (columns.names.index("kp1"),)


def gantry() -> Arm:
    """Two slides square to each other: neither feels how the other accelerates."""
    links = (Link(3.0), Link(1.0))
    joints = (
        Joint(type="prismatic", link=links[0]),
        Joint(type="prismatic", alpha_rad=np.pi / 2, link=links[1]),
    )
    return Arm(
        "gantry", joints, gravity_m_s2=(-9.80665, 0.0, 0.0), control=Control("pd", (40.0, 60.0), (-9.0, -7.0))
    )


def gantry_trials(arm: Arm) -> list[Trial]:
    rng = np.random.default_rng(0)
    trials = []
    for number in range(3):
        ref = np.repeat(rng.uniform(-0.5, 0.5, (4, 2)), 250, axis=0)
        m = simulate(arm, ref, 0.004, np.zeros(2))
        trials.append(Trial(f"gantry#{number}", m.t, 0.004, m.q, m.dq, m.ddq, m.tau, m.ref))
    return trials


def test_parts_that_don_t_feel_each_other_have_factors_of_their_own():
    arm = gantry()
    columns, space = null_space(arm, gantry_trials(arm), "pd")
    assert [columns.names[k] for k in space.given([]).leaders] == ["kp1", "kp2"]
    one = space.given([columns.names.index("kp1")])
    assert [columns.names[k] for k in one.leaders] == ["kp2"]
    assert space.given([columns.names.index("kp1"), columns.names.index("kp2")]).leaders == ()


def test_rows_times_true_values_are_zero(bench_trials):
    base, trial = base_parameters(ARM), bench_trials[0]
    columns = law_columns(ARM, base).narrowed("pd")
    values = columns.start(base.combination @ standard_parameters(ARM), ARM.control)
    rows = law_rows(ARM, base, trial.q, trial.dq, trial.ddq, trial.ref - trial.q)[..., : len(values)]
    moving = np.abs(trial.dq) > 0.02
    assert np.max(np.abs(rows @ values)[moving]) < 1e-9
    assert columns.control(values) == ARM.control
    assert np.array_equal(columns.law_table(values)[:2], [[9.5, 9.5], [-9.5, -9.5]])
