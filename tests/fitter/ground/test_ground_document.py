"""The document of a ground fit: segments' numbers by hand, and errors by finite differences."""

import json

import numpy as np
import pytest

from benchmarks.simulated_people.ground import BASE, PERSON, moving, other_masses, trial_of, weighing
from fitter.ground.ground_document import document, known_together, left_at_prior, segment_rows
from fitter.ground.ground_dynamics import learn_from_ground
from fitter.ground.ground_score import ground_score
from fitter.ground.link_names import link_names

NAMES = link_names(PERSON)


@pytest.fixture(scope="module")
def learnt():
    rng = np.random.default_rng(1)
    theta = other_masses(BASE, rng)
    person = weighing(PERSON, theta)
    q = moving(PERSON, rng, 6.0)
    trial = trial_of(person, BASE, q, q, theta, rng.normal(0.0, [1.0] * 3 + [0.3] * 3, (len(q), 6)))
    return trial, learn_from_ground(person, BASE, [trial], regression=True, band_hz=2.0)


def about_centre(theta):
    """Return mass, centre and inertia about the centre by the parallel-axis theorem, (10,)."""
    m, c = theta[9], theta[6:9] / theta[9]
    six = theta[[0, 3, 4, 3, 1, 5, 4, 5, 2]].reshape(3, 3) - m * (c @ c * np.eye(3) - np.outer(c, c))
    return np.array([m, *c, *six[[0, 1, 2, 0, 0, 1], [0, 1, 2, 1, 2, 2]]])


def test_segments_have_mass_centre_and_inertia_about_it(learnt):
    _, fit = learnt
    for k, row in enumerate(segment_rows(fit, NAMES)):
        own = slice(10 * k, 10 * k + 10)
        theta = fit.values[own]
        said = [row["mass_kg"]["value"], *row["com_m"]["value"], *row["inertia_kg_m2"]["value"]]
        np.testing.assert_allclose(said, about_centre(theta), rtol=1e-9, atol=1e-12)
        step = 1e-6 * np.maximum(np.abs(theta), 1e-3)
        J = np.column_stack(
            [(about_centre(theta + s) - about_centre(theta - s)) / (2.0 * s.sum()) for s in np.diag(step)]
        )
        std, before = (np.sqrt(np.diag(J @ C[own, own] @ J.T)) for C in (fit.covariance, fit.prior_covariance))
        found = [row["mass_kg"]["std"], *row["com_m"]["std"], *row["inertia_kg_m2"]["std"]]
        np.testing.assert_allclose(found, std, rtol=1e-4)
        share = np.clip(1.0 - (std / before) ** 2, 0.0, 1.0)
        shares = [row["learnt"]["mass"], *row["learnt"]["com"], *row["learnt"]["inertia"]]
        np.testing.assert_allclose(shares, share, atol=1e-4)
        prior = about_centre(fit.before[own])
        np.testing.assert_allclose([row["mass_kg"]["prior"], *row["com_m"]["prior"]], prior[:4])
        assert row["segment"] == NAMES[BASE.bodies[k]] and row["joint"] == BASE.bodies[k] + 1


def test_the_document_is_json_and_tells_roles_apart(learnt):
    trial, fit = learnt
    score = ground_score(fit.arm, BASE, [trial], fit.before, fit.values, fit.plates, 2.0)
    found = document(fit, {"learn": score, "evaluate": None}, [trial], NAMES, prior=True)
    assert found["ground_residual"]["evaluate"] is None and found["explained"]["evaluate"] is None
    explained = np.array(found["explained"]["learn"])
    assert np.flatnonzero(np.isfinite(explained)).tolist() == sorted(BASE.joints)
    np.testing.assert_array_equal(explained[list(BASE.joints)], score.explained)
    total = found["total_mass_kg"]
    assert total["value"] == pytest.approx(fit.values[9::10].sum()) and total["std"] > 0.0
    assert found["clock_shift_s"] == {"moves": 0.0} and found["contacts"] == []
    assert all(one["learnt"] == share for one, share in zip(found["parameters"].values(), fit.learnt, strict=True))
    assert set(json.loads(json.dumps(found))) >= {
        "segments",
        "plates",
        "combinations",
        "left_at_prior",
        "known_together",
    }
    bare = document(fit, {"learn": score, "evaluate": score}, [trial], NAMES, prior=False)
    assert "left_at_prior" not in bare and "learnt" not in next(iter(bare["parameters"].values()))


def test_contacts_count_links_from_one(learnt):
    trial, fit = learnt
    touching = type(trial)(**{**trial.__dict__, "contacts": (("plate", 11),)})
    found = document(fit, {"learn": None, "evaluate": None}, [touching], NAMES, prior=False)
    assert found["contacts"] == [{"trial": "moves", "plate": "plate", "joint": 12}]


def test_what_is_left_at_the_prior_is_named(learnt):
    _, fit = learnt
    names = left_at_prior(fit)
    learnt_of = dict(zip(fit.names, fit.learnt, strict=True))
    assert names and all(learnt_of[name] < 0.1 for name in names)
    assert all(learnt_of[name] >= 0.1 for name in set(fit.names) - set(names))


def test_sums_of_what_is_not_known_alone_are_named(learnt):
    _, fit = learnt
    alone = {name for name, one in fit.parameters.items() if one.identifiable}
    together = known_together(fit)
    assert together
    for names in together:
        assert len(names) > 1 and not alone.issuperset(names)
