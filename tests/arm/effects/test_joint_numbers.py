"""The numbers of a joint that a simulation knows."""

from arm.effects.catalogue import catalogue
from arm.effects.joint_numbers import N_NUMBER


def test_each_number_is_that_of_one_effect():
    """And is one of its parameters."""
    stated = [(place, name, kind) for kind in catalogue().values() for place, name in kind.simulated.items()]
    assert sorted(place for place, *_ in stated) == list(range(N_NUMBER))
    assert all(name in {one.name for one in kind.numbers} for _, name, kind in stated)
