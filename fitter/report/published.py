"""The paper's own figures, to stand beside ours."""

#: Section 8.2, real against virtual arm under law (5) with its true gains: mean and largest error [deg].
ANGLE_ERROR_DEG = {"learn": (0.73, 3.51), "evaluate": (1.91, 12.7)}
#: Table 2, calibrated from the real arm.
KINEMATICS = {"a1": 0.245785, "a2": 0.303113, "alpha2": -0.000024, "beta2": -0.003617}
#: Table 4, row 1: calibrated with the arm's own gains, 300 000 samples.
DYNAMICS = {
    "I1+m2*L1^2": 1.985170,
    "m2*sx2": 1.717460,
    "m2*sy2": 0.175769,
    "I2": 0.470695,
    "D1": 0.021347,
    "D2": 0.001663,
    "fc1": -0.007767,
    "fc2": 0.000015,
}
#: The arm of which these were found.
ARM = "dd-arm"
