"""The box in which a limb is searched."""

from dataclasses import replace

import numpy as np

from fitter.limb.search_box import LONGEST_BONE_M, search_box
from tests.fitter.limb.simulated_task import simulated_task


def test_the_box_knows_the_presets_axes_and_nothing_of_the_person():
    known = simulated_task()
    prior, free = known.task.prior.geometry, known.task.free
    numbers = prior.numbers.copy()
    for kind, i in free.what:
        if kind in (1, 2):  # a and d
            numbers[i, kind] += 0.1
    taller = replace(prior, numbers=numbers, base_p=np.array([0.1, 0.2, -0.3]))
    mine, other = search_box(free, prior), search_box(free, taller)
    np.testing.assert_array_equal(mine.geometry(mine.lower).numbers, other.geometry(other.lower).numbers)
    np.testing.assert_array_equal(other.geometry(np.zeros(len(free.std))).base_p, np.zeros(3))
    np.testing.assert_array_equal(mine.lower, -mine.upper)
    lengths = [name[0] in "ad" and "alpha" not in name for name in free.names]
    np.testing.assert_array_equal(mine.upper[lengths], LONGEST_BONE_M)
    assert np.all(mine.upper[[name.startswith(("alpha", "beta")) for name in free.names]] == np.pi / 6)


def test_the_true_limb_lies_in_the_box():
    known = simulated_task()
    box = search_box(known.task.free, known.task.prior.geometry)
    genes = known.geometry.away(known.task.free, box.origin)
    assert np.all((box.lower < genes) & (genes < box.upper))
    np.testing.assert_allclose(box.geometry(genes).numbers, known.geometry.numbers, atol=1e-15)
