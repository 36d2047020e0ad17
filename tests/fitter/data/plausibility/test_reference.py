"""A target that is to be simulated is questioned as angles are."""

from dataclasses import replace

import numpy as np
import pytest

from fitter.data.plausibility.reference import look
from fitter.data.plausibility.refusal import Refusal


def test_a_target_in_degrees_or_milliseconds_is_refused(arm, clean):
    motion = clean()
    target = replace(motion, columns={"ref": motion.columns["q"]})
    assert look(target, arm) is target
    with pytest.raises(Refusal, match="degrees"):
        look(replace(target, columns={"ref": np.rad2deg(motion.columns["q"])}), arm)
    with pytest.raises(Refusal, match="milliseconds"):
        look(replace(target, t=1e3 * target.t), arm)
