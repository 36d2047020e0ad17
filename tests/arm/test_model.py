"""The small things an arm can be asked."""

import numpy as np
import pytest

from arm.model import Arm, Joint


def test_a_sensor_is_found_by_its_name(dd_arm):
    assert dd_arm.sensor_index("s3") == 2
    with pytest.raises(KeyError, match="s9"):
        dd_arm.sensor_index("s9")


def test_new_geometry_makes_a_new_arm(dd_arm):
    longer = dd_arm.with_joints(a_m=np.array([0.26, 0.31]), beta_rad=np.array([0.0, 0.01]))
    assert [joint.a_m for joint in longer.joints] == [0.26, 0.31]
    assert longer.joints[1].beta_rad == 0.01 and type(longer.joints[1].beta_rad) is float
    assert longer.joints[0].link == dd_arm.joints[0].link
    assert [joint.a_m for joint in dd_arm.joints] == [0.25, 0.3]


def test_an_arm_has_as_many_joints_as_it_is_given():
    assert Arm("seven", (Joint(),) * 7).n_joint == 7
