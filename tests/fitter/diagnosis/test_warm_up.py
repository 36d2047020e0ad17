"""Going through a search compiles its kernels."""

from fitter.diagnosis import mass_determinants
from fitter.diagnosis.torque import background_fit, kalman, pulse_search
from fitter.diagnosis.warm_up import warm_up


def test_kernels_of_the_search_for_pushes_and_of_masses_are_compiled():
    warm_up()
    for kernel in (
        background_fit._of_trial,
        kalman.innovations,
        kalman.predicted,
        pulse_search._evidence,
        mass_determinants.log_determinant,
        mass_determinants.solved_slopes,
        mass_determinants.determinant_slopes,
    ):
        assert kernel.signatures, kernel
