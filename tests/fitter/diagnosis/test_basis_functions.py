"""What functions of a few variables can be, against the same functions written out."""

from types import SimpleNamespace
from typing import cast

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from fitter.diagnosis.basis_functions import BasisFunctions, names, spellings, symbolic_terms, variable
from fitter.diagnosis.motion import Motion

RNG = np.random.default_rng(5)


def motion(number: int, size: int = 600) -> Motion:
    q, dq = RNG.uniform(-1.2, 0.8, (size, 2)), RNG.uniform(-3.0, 5.0, (size, 2))
    return cast(Motion, SimpleNamespace(number=number, t=np.arange(size) * 0.01, q=q, dq=dq))


MOTIONS = [motion(1), motion(2)]
FUNCTIONS = BasisFunctions(MOTIONS, 2)


def left(columns: np.ndarray, values: np.ndarray, inside: np.ndarray) -> float:
    """Return what the best combination of columns leaves of a function, as a share of it."""
    some, of = columns[inside], values[inside]
    return float(np.std(some @ np.linalg.lstsq(some, of, rcond=None)[0] - of) / np.std(of))


def inner(one: Motion, *some: str) -> np.ndarray:
    """Return where all variables are within the range that functions reach over."""
    values = np.stack([variable(one, name) for name in some])
    low, high = np.quantile(values, [0.01, 0.99], axis=1)
    return np.all((values > low[:, None]) & (values < high[:, None]), axis=0)


def test_every_variable_has_a_name():
    assert names(2) == ["q1", "q2", "dq1", "dq2", "sign(dq1)", "sign(dq2)", "t"]
    one = MOTIONS[0]
    assert np.array_equal(variable(one, "q2"), one.q[:, 1])
    assert np.array_equal(variable(one, "sign(dq1)"), np.sign(one.dq[:, 0]))
    assert np.array_equal(variable(one, "t"), one.t)


@given(powers=st.tuples(*[st.integers(0, 4)] * 3).filter(lambda powers: sum(powers) <= 4 and sum(powers) > 0))
def test_a_polynomial_of_three_variables_is_one(powers):
    some = ("q1", "dq1", "q2")
    for one in MOTIONS:
        values = np.prod([variable(one, name) ** power for name, power in zip(some, powers, strict=True)], axis=0)
        assert left(FUNCTIONS.polynomials(one, some), values, inner(one, *some)) < 1e-9


def test_it_goes_on_where_no_motion_was():
    one, other = motion(3), motion(4)
    one.q[one.q[:, 0] > 0.0, 1] *= 0.3  # where q1 is positive, q2 is never large
    functions, some = BasisFunctions([one, other], 2), ("q1", "q2", "dq1")
    errors = []
    for kind in (functions.b_splines, functions.polynomials):
        known, unknown = kind(one, some), kind(other, some)
        values = [np.sin(m.q[:, 0]) * np.cos(m.q[:, 1]) * m.dq[:, 0] for m in (one, other)]
        factors = np.linalg.lstsq(known, values[0], rcond=None)[0]
        errors.append(float(np.std(unknown @ factors - values[1]) / np.std(values[1])))
    assert errors[1] < errors[0] / 2.0


@pytest.mark.parametrize("j", [0, 1])
def test_hats_have_the_kink_of_friction(j):
    name = f"dq{j + 1}"
    for one in MOTIONS:
        assert left(FUNCTIONS.b_splines(one, [name]), np.abs(variable(one, name)), inner(one, name)) < 1e-9
        assert left(FUNCTIONS.polynomials(one, [name]), np.abs(variable(one, name)), inner(one, name)) > 0.03


def test_a_sign_turns_a_whole_function_round():
    one, some = MOTIONS[0], ("q1", "sign(dq2)")
    values = np.where(one.dq[:, 1] > 0.0, one.q[:, 0] ** 2, -3.0 * one.q[:, 0])
    assert left(FUNCTIONS.polynomials(one, some), values, inner(one, "q1")) < 1e-9


def test_with_fewer_variables_a_function_is_finer():
    """So a second variable never wins for being one more."""
    one = MOTIONS[0]
    values, inside = np.tanh(one.q[:, 0] / 0.2), inner(one, "q1", "q2")
    for kind in (FUNCTIONS.b_splines, FUNCTIONS.polynomials):
        errors = [left(kind(one, some), values, inside) for some in (["q1"], ["q1", "sign(dq1)"])]
        assert errors[0] < errors[1]


DRAWN = np.random.default_rng(6)
MOTION = cast(
    Motion, SimpleNamespace(t=np.arange(50.0), q=DRAWN.normal(size=(50, 2)), dq=DRAWN.normal(size=(50, 2)))
)


@pytest.mark.parametrize(
    ("some", "name", "values"),
    [
        (("q1",), "q1^3", MOTION.q[:, 0] ** 3),
        (("dq2",), "dq2|dq2|", MOTION.dq[:, 1] * np.abs(MOTION.dq[:, 1])),
        (("t", "sign(dq1)"), "t sign(dq1)", MOTION.t * np.sign(MOTION.dq[:, 0])),
        (("dq1", "sign(dq2)"), "|dq1| sign(dq2)", np.abs(MOTION.dq[:, 0]) * np.sign(MOTION.dq[:, 1])),
        (
            ("q1", "dq1", "q2"),
            "sin(q1) dq1 cos(q2)",
            np.sin(MOTION.q[:, 0]) * MOTION.dq[:, 0] * np.cos(MOTION.q[:, 1]),
        ),
    ],
)
def test_a_product_is_what_it_is_called(some, name, values):
    columns, written = symbolic_terms(MOTION, some), spellings(some)
    assert columns.shape == (50, len(written))
    assert len(set(written)) == len(written)
    assert np.allclose(columns[:, written.index(name)], values)
