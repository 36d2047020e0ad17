"""A fit that has an axis where no person has it is begun once more; one that has not stays as it is."""

from dataclasses import replace

import numpy as np
import pytest

from fitter.limb.bundle import cost_of, fit_bundle
from fitter.limb.second_start import begun_again, is_doubtful
from tests.fitter.limb.simulated_task import simulated_task


@pytest.fixture(scope="module")
def known():
    return simulated_task(n=30)


@pytest.fixture(scope="module")
def fit(known):
    return fit_bundle(known.task, known.geometry, known.markers, known.q)


def test_a_fit_near_its_prior_stays(known, fit):
    assert not is_doubtful(known.task, fit)
    assert begun_again(known.task, fit, 0) is fit


def test_an_axis_far_from_its_prior_is_left(known, fit):
    task = known.task
    step = np.zeros(len(task.free.std))
    turned = next(k for k, name in enumerate(task.free.names) if name.startswith("alpha"))
    step[turned] = 5.0 * task.free.std[turned]
    wrong = replace(fit, geometry=fit.geometry.moved(task.free, step))
    assert is_doubtful(task, wrong)
    found = begun_again(task, wrong, 0)
    best = cost_of(task, fit.geometry, fit.markers, fit.q)
    here = cost_of(task, found.geometry, replace(found.markers, std=fit.markers.std), found.q)
    assert here == pytest.approx(best, abs=0.05 * abs(best)) and not is_doubtful(task, found)
