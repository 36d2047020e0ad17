"""The likelihood ratio of a column in Student's noise, against scipy's density."""

import numpy as np
import pytest
import scipy.optimize
import scipy.stats

from fitter.diagnosis.torque.student_ratio import likeliest_ratio, log_ratio


@pytest.mark.parametrize("nu", [3.0, 8.0, 100.0])
def test_the_likelihood_ratio_is_that_of_students_distribution(nu):
    rng = np.random.default_rng(2)
    s = rng.normal(size=60)
    e = 0.7 * s + scipy.stats.t.rvs(nu, size=60, random_state=rng)

    def loss(c):
        return -float(np.sum(scipy.stats.t.logpdf(e - c * s, nu)))

    best = scipy.optimize.minimize_scalar(loss, bounds=(-5.0, 5.0), method="bounded")
    ratio, c = likeliest_ratio(e, s, nu)
    assert c == pytest.approx(best.x, abs=0.01)
    assert ratio == pytest.approx(loss(0.0) - best.fun, abs=0.01)


def test_the_log_ratio_is_that_of_two_densities():
    e, other = np.random.default_rng(3).normal(size=(2, 20))
    density = scipy.stats.t(4.0).logpdf
    assert log_ratio(e, other, 4.0) == pytest.approx(float(np.sum(density(e) - density(other))))
