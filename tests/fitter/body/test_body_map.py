"""A body taken apart: its limbs are the presets of limbs, link by link."""

from dataclasses import replace

import numpy as np

from arm.body.limbs import BODY, MEAN_PERSON
from fitter.body.body_map import body_with_limbs


def test_limbs_have_the_bodys_lengths_and_hang_where_it_says():
    arm, where = body_with_limbs(replace(MEAN_PERSON, preset=BODY))
    assert [limb.segment for limb in where.limbs] == ["pelvis", "pelvis", "thorax", "thorax"]
    covered = sorted(k for limb in where.limbs for k in range(limb.first, limb.first + limb.arm.n_joint))
    assert covered == list(range(where.links["thorax"] + 1, arm.n_joint))
    for limb in where.limbs:
        assert arm.parents[limb.first] == where.links[limb.segment]
        own = arm.joints[limb.first : limb.first + limb.arm.n_joint]
        for name in ("a_m", "d_m"):
            np.testing.assert_allclose(
                [getattr(j, name) for j in own], [getattr(j, name) for j in limb.arm.joints], atol=1e-12
            )
