"""On exact data there is no floor and residuals are the noise; an effect that is missing stands in the floor."""

import numpy as np

from arm.effects.catalogue import catalogue
from arm.model import Effect
from fitter.diagnosis.at_joint import AtJoint
from fitter.diagnosis.model import Model
from tests.fitter.diagnosis.torque.runs import likelihood

DRAG = (Effect("quadratic_drag", {"drag_N_m_s2": 0.3}, joints=(1,)),)


def test_an_exact_model_leaves_the_sensors_noise():
    run = likelihood()
    fit = run.judged(run.fit(Model()))
    n = sum(one.n_effective for one in run.weights_of(fit).values())
    left = sum(
        float(np.sum((run.weights_of(fit)[m.number].rows(run.system(Model(), m).Z) @ np.append(-fit.x, 1.0)) ** 2))
        for m in run.motions
    )
    assert 0.75 * n < left < 1.25 * n
    white = np.diag(run._white_torque)  # noqa: SLF001 - what its noise was measured to be
    assert all(np.all(floor[0] < white) for floor in fit.floors.values())


def test_what_a_model_lacks_is_its_floor_and_its_cause_takes_it_away():
    run = likelihood(DRAG)
    base = run.judged(run.fit(Model()))
    drag = AtJoint(catalogue()["quadratic_drag"], 0)
    found = run.judged(run.fit(Model().plus(drag, np.zeros(0)), base))
    assert found.total > base.total + 50.0
    np.testing.assert_allclose(found.x[-1], 0.3, rtol=0.1)
    total = [sum(float(np.sum(floor[0])) for floor in fit.floors.values()) for fit in (base, found)]
    assert total[1] < 0.2 * total[0]


def test_blocks_add_up_and_know_their_trials():
    run = likelihood()
    fit = run.judged(run.fit(Model()))
    assert len(fit.nats) == sum(run.n_block(motion) for motion in run.motions)
    assert set(fit.trial[fit.learnt]) == {motion.number for motion in run.learning}
    assert fit.total == float(fit.nats.sum())


def test_a_fit_is_begun_with_the_factors_of_a_smaller_one():
    run = likelihood(DRAG)
    base = run.fit(Model())
    begun = run.begun(base, Model().plus(AtJoint(catalogue()["quadratic_drag"], 0), np.zeros(0)))
    np.testing.assert_array_equal(begun, np.append(base.x, 0.0))
