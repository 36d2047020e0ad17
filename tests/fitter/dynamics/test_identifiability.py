"""What a motion reveals, against motions of which that is known beforehand."""

import json
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from arm.arm_file import load_arm
from arm.base_parameters import base_parameters
from arm.regressor import regressor, standard_parameters
from fitter.dynamics.identifiability import FELT, KNOWN, report
from fitter.dynamics.torque_problem import torque_problem
from fitter.regression_sums.torque_sums import row_sums
from limbcal.command import to_json

ARM = load_arm("dd-arm")
BASE = base_parameters(ARM)
TRUE = BASE.combination @ standard_parameters(ARM)
INDEX = {name: k for k, name in enumerate(BASE.names)}


def waves(seconds=8.0, dt=0.004):
    t = np.arange(round(seconds / dt)) * dt
    w, phase = np.array([2.1, 3.3]), np.array([0.3, 1.1])
    q = np.sin(np.outer(t, w) + phase)
    return q, w * np.cos(np.outer(t, w) + phase), -(w**2) * q


def one_way(seconds=4.0, dt=0.004):
    t = np.arange(round(seconds / dt))[:, None] * dt
    a, b = np.array([0.15, -0.2]), np.array([0.1, -0.05])
    return (
        a * t**2 + b * (t - np.sin(3 * t) / 3),
        2 * a * t + b * (1 - np.cos(3 * t)),
        2 * a + 3 * b * np.sin(3 * t),
    )


def sums_of(motion, noise=0.001, twist=None, values=TRUE):
    rows = regressor(ARM, *motion)[..., list(BASE.independent)]
    if twist is not None:
        rows = twist(rows)
    tau = rows @ values + noise * np.random.default_rng(0).normal(size=rows.shape[:2])
    return row_sums(rows, tau, np.abs(motion[1]) > 0.02)


def said_of(sums, held=None):
    return report(ARM, BASE, torque_problem(sums, TRUE, held))


def test_a_motion_that_reveals_all():
    found = said_of(sums_of(waves(), 1e-5))
    assert [set(c.weights) for c in found.combinations] == [{name} for name in BASE.names]
    assert all(c.revealed for c in found.combinations)
    assert not found.sentences()


def test_relative_errors_are_those_of_the_covariance():
    sums = sums_of(waves(), 1e-3)
    problem = torque_problem(sums, TRUE)
    values = problem.complete(problem.optimum())
    std = problem.standard_errors(values)
    for c in report(ARM, BASE, problem).combinations:
        if len(c.weights) == 1:
            k = INDEX[next(iter(c.weights))]
            felt = FELT * np.sqrt(sums.power.sum(axis=0)[sums.gram.sum(axis=0)[:, k, k] > 0].sum())
            size = max(abs(values[k]), felt / np.sqrt(sums.gram.sum(axis=(0, 1))[k, k]))
            assert c.relative_std == pytest.approx(std[k] / size)
            assert c.revealed == (c.relative_std < KNOWN)


@settings(max_examples=20, deadline=None)
@given(share=st.floats(0.2, 5.0), first=st.sampled_from(["m2*sx2", "I2"]), second=st.sampled_from(["fc2", "D2"]))
def test_columns_that_are_alike_are_only_revealed_together(share, first, second):
    """If one column is a multiple of another, exactly their weighted sum is revealed."""
    a, b = INDEX[first], INDEX[second]

    def twist(rows):
        rows = rows.copy()
        rows[..., b] = share * rows[..., a]
        return rows

    gram = sums_of(waves(), 1e-5, twist).gram.sum(axis=(0, 1))
    alike = 10.0 / np.sqrt(np.diag(gram))  # every parameter is felt as much as every other
    found = report(ARM, BASE, torque_problem(sums_of(waves(), 1e-5, twist, alike), alike))
    pairs = [c for c in found.combinations if len(c.weights) == 2]
    identified, unidentified = (next(c for c in pairs if c.revealed == revealed) for revealed in (True, False))
    assert set(identified.weights) == set(unidentified.weights) == {first, second}
    assert identified.weights[second] / identified.weights[first] == pytest.approx(share, rel=1e-6)
    # what is open is a move of both that leaves the sum where it is
    assert np.isinf(unidentified.relative_std)
    assert identified.relative_std < KNOWN
    assert (
        f"{first} and {second} not one by one" in identified.sentence
        or f"{second} and {first}" in identified.sentence
    )
    others = [c for c in found.combinations if c not in pairs]
    assert all(c.revealed and len(c.weights) == 1 for c in others)


def test_friction_behind_an_unknown_constant():
    known, unknown = sums_of(one_way(), 1e-5), sums_of(one_way(), 1e-5).centred()
    assert "constant torque" not in " ".join(said_of(known).sentences())
    found = said_of(unknown)
    assert "fc1 is revealed only together with a constant torque of joint 1" in " ".join(found.sentences())
    assert "fc2 is revealed only together with a constant torque of joint 2" in " ".join(found.sentences())
    coulomb = [c for c in found.combinations if "fc1" in c.weights]
    assert len(coulomb) == 1
    assert not coulomb[0].revealed


def test_a_joint_that_did_not_move():
    q, dq, ddq = (x.copy() for x in waves())
    q[:, 0] = dq[:, 0] = ddq[:, 0] = 0.0
    found = said_of(sums_of((q, dq, ddq), 1e-5))
    for name in ("I1+m2*L1^2", "D1", "fc1"):
        open_ = [c for c in found.combinations if name in c.weights]
        assert len(open_) == 1
        assert open_[0].sentence == f"{name} is revealed not at all"
    assert [set(c.weights) for c in found.combinations if c.revealed] == [{"I2"}, {"D2"}, {"fc2"}]


def test_what_is_held_is_left_out():
    found = said_of(sums_of(waves(), 1e-5), {INDEX["I2"]: TRUE[INDEX["I2"]]})
    assert "I2" not in {name for c in found.combinations for name in c.weights}
    assert len(found.combinations) == 7


def test_the_document_is_json():
    noisy = said_of(sums_of(one_way(), 0.3).centred())
    document = json.loads(to_json(noisy.document()))
    assert set(document) == {"condition_number", "combinations"}
    assert all(set(c) == {"combination", "relative_std", "revealed", "sentence"} for c in document["combinations"])
    assert any(c["relative_std"] is None for c in document["combinations"])
    few = replace(sums_of(waves(0.2)).total())  # one block: no scatter to be seen, white noise is assumed
    assert np.isfinite([c.relative_std for c in said_of(few).combinations][0])
