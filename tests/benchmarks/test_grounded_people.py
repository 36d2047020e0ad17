"""Simulated people on force plates: what is drawn, what is hidden, and how answers are judged."""

import numpy as np
import pytest

from arm.physical_links import is_possible
from benchmarks.grounded_people import (
    RAIL,
    SKIN_M,
    drawn,
    ground,
    judged,
    leant,
    one_plate,
    page,
    seen,
    skin_of,
    squats,
)


@pytest.fixture(scope="module")
def person():
    return drawn(np.random.default_rng(1))


@pytest.fixture(scope="module")
def q():
    return squats(np.random.default_rng(2))


def test_a_person_can_exist_and_is_off_the_table(person):
    assert all(is_possible(link) for link in person.theta.reshape(-1, 10))
    off = person.theta[9::10] / person.base.links[:, 9] - 1.0
    assert 0.1 < off.std() < 0.35
    assert person.arm.body.mass_kg == pytest.approx(person.theta[9::10].sum())


def test_skin_goes_with_the_posture_by_its_size_and_alike_each_time(person, q):
    skin = skin_of(person.arm, np.random.default_rng(3))
    one, other = (seen(person.arm, q, skin, np.random.default_rng(seed)) for seed in (4, 5))
    bone = seen(person.arm, q, 0.0 * skin, np.random.default_rng(6))
    off = np.sqrt(np.mean(np.sum((one - bone) ** 2, axis=2), axis=0))
    assert np.all(np.abs(off - SKIN_M) < 0.001)
    assert np.abs(one - other).max() < 0.005


def test_the_ground_carries_the_weight_and_a_rail_takes_its_share(person, q):
    rng = np.random.default_rng(7)
    wrench, weight = ground(person, q, rng), 9.80665 * person.theta[9::10].sum()
    assert wrench[:, 2].mean() == pytest.approx(weight, rel=0.01)
    taken = (wrench - leant(person, q, wrench, rng))[:, :3]
    assert np.all(taken[:50] == 0.0)
    assert RAIL[0] <= np.linalg.norm(taken[-1]) / weight <= RAIL[1]
    assert 0.2 < np.min(one_plate(wrench, rng)[:, 2] / wrench[:, 2]) < 0.4


def found(person, shift):
    """Return a document that has one combination, `shift` standard errors too large."""
    names = [f"p{k}" for k in range(len(person.theta))]
    value = 2.0 * person.theta[9] + shift * 0.1
    return {
        "parameters": dict.fromkeys(names),
        "combinations": [{"terms": {"p9": 2.0}, "value": value, "std": 0.1}],
        "total_mass_kg": {"value": 1.01 * person.theta[9::10].sum()},
        "ground_residual": {"evaluate": {"squared_reduction": {"moment": 0.9, "force": 0.7}}},
    }


def test_an_answer_is_judged_by_the_truth(person):
    line = judged(person, 0, found(person, 1.5), person.arm)
    assert line["z"] == [pytest.approx(1.5)] and line["mass_ratio"] == pytest.approx(1.01)
    assert line["possible"] and line["reduction"]["moment"] == 0.9


def test_the_page_counts_what_holds_and_lists_what_was_refused(person):
    both = {"refused": {"rail": True, "half": False}, "seconds": 2.0}
    lines = [
        {"key": "person/0", **judged(person, 0, found(person, 1.5), person.arm), **both},
        {"key": "person/1", **judged(person, 0, found(person, 2.5), person.arm), **both},
        {"key": "person/2", **judged(person, 4, {"notes": [{"text": "a rail"}]}, None), **both},
    ]
    text = page(lines)
    assert "| refused although all is measured | 1 |" in text
    assert "| 95 % intervals that hold | 50.0 % |" in text
    assert "| hand on a rail: refused | 3 / 3 |" in text and "| person/2 | a rail |" in text
    assert "| person/0 | half not refused |" in text
