"""The tail of the evidence by chance: its scale is found, cut off or not, and theory's is the least."""

import numpy as np
import pytest

from fitter.diagnosis.torque.pulses import Tail


@pytest.mark.parametrize("scale", [1.5, 3.0])
@pytest.mark.parametrize("most", [np.inf, 10.0])
def test_the_scale_of_a_long_tail_is_found_though_it_is_cut_off(scale, most):
    drawn = 2.0 + np.random.default_rng(0).exponential(scale, 20_000)
    tail = Tail.of(drawn[drawn < most], min(most, 1e3))
    assert tail.scale == pytest.approx(scale, rel=0.05)


def test_probabilities_are_the_frequencies_of_the_tail():
    drawn = np.random.default_rng(1).exponential(2.0, 100_000)
    tail = Tail.of(drawn[:1000], 1e3)
    for evidence in (4.0, 8.0):
        assert np.exp(-tail.surprisal(evidence)) == pytest.approx(np.mean(drawn > evidence), rel=0.25)


def test_a_background_that_follows_its_model_has_the_tail_of_theory():
    assert Tail.of(np.full(10, 3.0), 9.0).scale == 1.0
    assert Tail.of(3.0 + np.random.default_rng(2).exponential(0.2, 100), 9.0).scale == 1.0


def test_of_no_blocks_the_tail_is_that_of_theory():
    assert Tail.of(np.zeros(0), 9.0).surprisal(5.0) == pytest.approx(np.log(2.0) + 5.0)


def test_excesses_as_frequent_far_out_as_near_have_no_end():
    tail = Tail.of(np.linspace(0.0, 10.0, 101), 10.0)
    assert tail.surprisal(50.0) < 3.0
