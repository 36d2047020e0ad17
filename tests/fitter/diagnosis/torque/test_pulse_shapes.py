"""All shapes of a pulse that are sought: two durations an octave in every form, where all they last is known."""

import numpy as np
import pytest

from fitter.diagnosis.torque.background import LONGEST_PULSE_S
from fitter.diagnosis.torque.pulse import Shapes, durations
from fitter.diagnosis.torque.pulse_column import FORMS, in_rows
from tests.fitter.diagnosis.torque.residuals import trial


@pytest.mark.parametrize("step_s", [0.01, 0.04, 0.1])
def test_durations_are_two_an_octave_from_two_rows_to_the_longest(step_s):
    sought = durations(step_s)
    assert sought[0] == pytest.approx(2.0 * step_s)
    np.testing.assert_allclose(sought[2:] / sought[:-2], 2.0)
    assert sought[-1] <= LONGEST_PULSE_S * (1.0 + 1e-12) < sought[-1] * np.sqrt(2.0) * (1.0 + 1e-9)


def test_a_shape_is_the_pulse_that_begins_with_its_row():
    rows = trial(np.random.default_rng(1)).rows(0)
    shapes, k = Shapes.of(rows), 120
    assert len(shapes.values) == len(FORMS) * len(durations(rows.step_s))
    for i, (duration_s, form) in enumerate(zip(shapes.duration_s, shapes.form, strict=True)):
        column = in_rows(rows, float(rows.t[k]) - 0.5 * rows.step_s, duration_s, form)
        first = k - shapes.before[i]
        np.testing.assert_allclose(
            column[first : first + shapes.length[i]], shapes.values[i, : shapes.length[i]], atol=1e-6
        )


def test_shapes_are_made_once_for_rows_of_one_step():
    one, other = (trial(np.random.default_rng(seed)).rows(0) for seed in (1, 2))
    assert Shapes.of(one) is Shapes.of(other)


def test_a_shape_fits_where_half_of_the_rows_that_it_lasts_are_known():
    rows = trial(np.random.default_rng(1)).rows(0)
    shapes = Shapes.of(rows)
    rows.known[100:104] = False
    for fit, lasting in zip(shapes.fit(rows), shapes.lasting, strict=True):
        last = len(rows.t) - lasting
        expected = [k < last and np.mean(rows.known[k : k + lasting]) >= 0.5 for k in range(len(rows.t))]
        np.testing.assert_array_equal(fit, expected)
