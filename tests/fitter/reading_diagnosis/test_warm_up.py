"""Going through a diagnosis of sensors compiles its kernels."""

from fitter.reading_diagnosis import elimination, linearisation
from fitter.reading_diagnosis.warm_up import warm_up


def test_kernels_of_the_diagnosis_of_sensors_are_compiled():
    warm_up()
    for kernel in (
        elimination.eliminate,
        elimination.go_back,
        elimination.motion_at_knots,
        linearisation._observe_along,
    ):
        assert kernel.signatures, kernel
