"""Going through fit and tracking compiles their kernels."""

from fitter.limb import inverse_kinematics, motion_equations, normal_equations
from fitter.limb.warm_up import warm_up


def test_kernels_of_fit_and_tracking_are_compiled():
    warm_up()
    for kernel in (
        inverse_kinematics._follow,
        normal_equations.eliminate,
        normal_equations.bundle_cost,
        motion_equations.marker_equations,
        motion_equations.inverse_diagonal,
    ):
        assert kernel.signatures, kernel
