"""Which form of the law a motion supports."""

import numpy as np
import pytest

from arm.arm_file import load_arm
from arm.base_parameters import base_parameters
from fitter.controller.law_ambiguity import Ambiguity
from fitter.controller.law_columns import law_columns
from fitter.controller.law_fit import LawFit
from fitter.controller.law_forms import law_form, misfit

ARM = load_arm("dd-arm")
COLUMNS = law_columns(ARM, base_parameters(ARM), "pda")
N = len(COLUMNS.names)


def fitted(z: float) -> LawFit:
    """Return a fit whose accelerations' gains are ``z`` standard errors from zero."""
    nothing = Ambiguity(np.zeros((0, N)), (), np.zeros((0, N)), ())
    return LawFit(COLUMNS, np.full(N, z), np.arange(N), np.eye(N), nothing, np.zeros(2), True)


@pytest.mark.parametrize(("z", "needed"), [(3.28, ()), (3.30, ("ka1", "ka2"))])
def test_a_gain_is_needed_beyond_the_thousandth_quantile_of_the_normal_distribution(z, needed):
    form = law_form(fitted(z), np.tile(np.eye(N), (2, 1, 1)))  # 3.2905 in its tables
    assert form.needed == needed
    assert set(form.needed) | set(form.not_needed) == {"ka1", "ka2"}


def test_a_gain_whose_torque_is_less_than_a_hundredth_is_not_needed():
    gram = np.tile(np.eye(N), (2, 1, 1))
    for k in range(N - 2, N):
        gram[:, k, k] = 1e-5
    assert law_form(fitted(1e3), gram).needed == ()


def test_the_wider_form_that_is_needed_is_named():
    fits = {"pda": fitted(10.0)}
    wide = law_form(fits["pda"], np.tile(np.eye(N), (2, 1, 1)))
    narrow = law_form(fitted(0.0), np.tile(np.eye(N), (2, 1, 1)))
    found = misfit("pd", {"pd": narrow, "pda": wide}, fits)
    assert not found.fits
    assert found.missing == ("ka ddq",)
