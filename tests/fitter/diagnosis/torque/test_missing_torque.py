"""A residual's rows: two a period of the band's corner, known where all of their samples are."""

from dataclasses import replace

import numpy as np
import pytest

from tests.fitter.diagnosis.torque.residuals import trial


def test_rows_have_two_samples_a_period_of_the_band():
    part = replace(trial(np.random.default_rng(3)), band_hz=6.25)
    part.known[:1] = False
    rows = part.rows(0)
    assert rows.step_s == pytest.approx(0.08)
    assert not rows.known[0]
    assert rows.known[1:].all()
    assert rows.signals.shape == (len(rows.t), 2)
