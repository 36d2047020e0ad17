"""Derivatives and filter of one motion."""

import numpy as np
import pytest

from fitter.data.derivatives import differentiate, lowpass
from fitter.data.derived_trial import derive
from tests.fitter.data.random_columns import DDQ, DQ, DT_S, TAU, N, Q, uniform


@pytest.mark.parametrize(
    ("given", "source", "derived"),
    [
        (("q",), "q", "dq, ddq"),
        (("q", "dq"), "dq", "ddq"),
        (("q", "ddq"), "q", "dq"),
    ],
)
def test_a_missing_derivative_is_that_of_the_nearest_column(given, source, derived):
    columns = {"q": Q, "dq": DQ, "ddq": DDQ}
    trial = derive(uniform(**{name: columns[name] for name in given}), np.inf, np.inf)
    assert trial.notes[0].text == f"{derived} derived from {source} (zero phase, unfiltered)"
    expected = {
        "dq": DQ if "dq" in given else differentiate(Q, DT_S),
        "ddq": DDQ if "ddq" in given else differentiate(columns[source], DT_S, 1 if source == "dq" else 2),
    }
    for name, values in expected.items():
        np.testing.assert_array_equal(getattr(trial, name), values)
    assert trial.role == "learn" and trial.trimmed == 0 and trial.began_s == 7.0
    np.testing.assert_array_equal(trial.whole["q"], Q)


@pytest.mark.parametrize(
    ("cutoff_hz", "trim"), [(20.0, 54), (11.0, 95), (10.0, 100), (1.0, 100), (224.0, 9), (250.0, 0)]
)
def test_ends_are_trimmed_until_the_filter_has_settled_or_by_a_tenth(cutoff_hz, trim):
    trial = derive(uniform(q=Q, tau=TAU, ref=Q), cutoff_hz, 3.0)
    inner = slice(trim, N - trim)
    assert (trial.trimmed, len(trial.t)) == (trim, N - 2 * trim)
    assert trial.t[0] == 0.0 and trial.began_s == pytest.approx(7.0 + trim * DT_S)
    assert (trial.cutoff_hz, trial.band_hz) == (cutoff_hz, 3.0)
    np.testing.assert_array_equal(trial.q, lowpass(Q, DT_S, cutoff_hz)[inner])
    np.testing.assert_array_equal(trial.ddq, differentiate(lowpass(Q, DT_S, cutoff_hz), DT_S, 2)[inner])
    np.testing.assert_array_equal(trial.ref, Q[inner])
    np.testing.assert_array_equal(trial.tau_measured, TAU[inner])
    said = "unfiltered" if trim == 0 else f"all columns but ref low-passed at {cutoff_hz:.4g} Hz"
    assert trial.notes[0].text == f"dq, ddq derived from q (zero phase, {said})"
    assert [note.text for note in trial.notes[1:]] == (
        [f"{trim * DT_S:.3g} s trimmed at each end"] if trim else []
    )


def test_with_all_derivatives_nothing_is_whole_or_trimmed():
    trial = derive(uniform(q=Q, dq=DQ, ddq=DDQ, tau=TAU), 5.0, 3.0)
    assert trial.whole == {} and trial.trimmed == 0 and trial.notes == () and trial.ref_filtered is None
    np.testing.assert_array_equal(trial.tau, TAU)


def test_a_sample_is_contradicted_by_any_share_of_one():
    marked = np.zeros((N, 2))
    marked[500, 0], marked[501, 1] = 0.0009, 0.0011
    trial = derive(uniform(q=Q, contradicted=marked), np.inf, np.inf)
    assert np.argwhere(trial.contradicted).tolist() == [[501, 1]]
    np.testing.assert_array_equal(trial.counted, ~trial.contradicted)
    assert derive(uniform(q=Q), np.inf, np.inf).counted.all()
    np.testing.assert_array_equal(trial.whole["contradicted"], marked)  # another filter marks the same ones
