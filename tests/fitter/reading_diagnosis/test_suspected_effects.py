"""Columns of every suspect against differences of the residual."""

import numpy as np
import pytest

from fitter.reading_diagnosis.linearisation import instruments_of, linearise
from fitter.reading_diagnosis.sensor_frames import trials_of
from fitter.reading_diagnosis.sensor_hypotheses import Suspect
from fitter.reading_diagnosis.suspected_effects import EFFECTS

KINDS = {kind.name: kind for kind in reversed(EFFECTS)}

#: Where each is asked, and how far to either side, for what is not smooth in it is not small against noise.
AT = {"sensor_clipping": [4.0], "base_motion": [0.3, -0.2, 0.1, 0.2, 0.4, -0.1, 0.7]}
STEP = {"sensor_clipping": 1e-4}


@pytest.fixture(scope="module")
def trial(measured_run):
    return measured_run.arm, trials_of(measured_run.arm, measured_run.learn[:1])[0]


#: What is read late was sampled with noise, what is expected is smooth: its slopes differ.
SMOOTH = [name for name in KINDS if name != "time_skew"]


@pytest.mark.parametrize("name", SMOOTH)
def test_columns_are_slopes(trial, name):
    arm, frames = trial
    suspect = Suspect(KINDS[name], None if KINDS[name].whole else 3)
    rng, nominal = np.random.default_rng(0), instruments_of(arm)
    n = len(frames.values) + 2
    c = 0.4 * np.sin(np.outer(np.arange(n) * frames.dt_s, [3.0, 5.0]) + rng.uniform(0.0, 6.0, 2))
    at = np.array(
        AT.get(name, np.where(np.isfinite(suspect.kind.neutral), suspect.kind.neutral, 1.0)), dtype=float
    )
    if name == "sensor_highpass":
        at = at + 0.05

    def linearised(value):
        return linearise(frames, suspect.changed(nominal, value), c)

    here, step = linearised(at), STEP.get(name, 1e-5)
    columns = suspect.columns(here)
    assert columns.shape == (*here.expected.shape, len(at))
    for k in range(len(at)):
        more, less = (linearised(at + way * step * (np.arange(len(at)) == k)) for way in (1.0, -1.0))
        counts = (more.weight > 0.0) & (less.weight > 0.0) & (more.clipped == less.clipped)
        slope = np.where(counts, (less.residual - more.residual) / (2.0 * step), 0.0)
        expected = np.where(counts, columns[..., k], 0.0)
        np.testing.assert_allclose(slope, expected, atol=1e-3 * max(1.0, np.abs(expected).max()))


def test_those_that_begin_as_neutral_change_nothing_there(trial):
    nominal = instruments_of(trial[0])
    for kind in EFFECTS:
        if kind.begins_neutral:
            changed = Suspect(kind, None if kind.whole else 1).changed(nominal, np.array(kind.neutral))
            np.testing.assert_allclose(changed.bias, nominal.bias)
            assert changed.arm.sensors[1].rotation_rad == nominal.arm.sensors[1].rotation_rad
            assert changed.arm.sensors[1].position_m == nominal.arm.sensors[1].position_m


def test_a_level_begins_below_what_was_read_and_a_corner_where_none_is_known(trial):
    arm, frames = trial
    nominal = instruments_of(arm)
    top = np.nanmax(np.abs(frames.values[:, 9:12]))
    assert 0.9 * top < KINDS["sensor_clipping"].first([frames], nominal, 3)[0] < top
    assert KINDS["sensor_highpass"].first([frames], nominal, 3)[0] > KINDS["sensor_highpass"].least
    assert KINDS["sensor_highpass"].first([frames], nominal.with_entry("corner_hz", 3, 0.2), 3) is None
