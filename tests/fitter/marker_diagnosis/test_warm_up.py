"""Going through markers that are left out compiles the kernel."""

from fitter.marker_diagnosis import left_out
from fitter.marker_diagnosis.warm_up import warm_up


def test_the_kernel_of_markers_that_are_left_out_is_compiled():
    warm_up()
    assert left_out._left_out.signatures
