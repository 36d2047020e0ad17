"""What turns accelerations into motion is chosen by a word."""

import numpy as np
import pytest

from arm.model import Arm
from limbcal.errors import ConfigError
from tracking.dead_reckoning.integrator import Integrator
from tracking.kalman.kalman_filter import KalmanTracker
from tracking.model.innovation_test import Consistency
from tracking.tracker import consistency_of, tracker_of

STILL = np.tile([0.0, 0.0, 9.80665], (4000, 4))


@pytest.mark.parametrize(("method", "kind"), [("filter", KalmanTracker), ("integrate", Integrator)])
def test_frames_are_a_millisecond_apart_unless_said(dd_arm: Arm, method: str, kind: type) -> None:
    tracker = tracker_of(dd_arm, method, 4000.0)
    assert type(tracker) is kind and tracker.method == method and tracker.dt_s == pytest.approx(1e-3)
    assert tracker_of(dd_arm, method, 4000.0, None, 250.0).dt_s == pytest.approx(4e-3)
    assert consistency_of(tracker) == Consistency(None, 0, 0, False)


@pytest.mark.parametrize(("given", "q"), [(None, [0.0, 0.0]), ([0.3, -0.2], [0.3, -0.2])])
@pytest.mark.parametrize("method", ["filter", "integrate"])
def test_a_level_arm_rests_where_it_is_said_or_at_zero(
    dd_arm: Arm, method: str, given: list[float] | None, q: list[float]
) -> None:
    tracker = tracker_of(dd_arm, method, 4000.0, None if given is None else np.array(given))
    frames, phases = tracker.push(0, STILL)
    assert phases == []
    found = np.vstack([part.q for part in frames])
    assert len(found) > 900
    np.testing.assert_allclose(found, np.tile(q, (len(found), 1)), rtol=0, atol=1e-6)


def test_only_the_filter_judges_itself(dd_arm: Arm) -> None:
    trackers = [tracker_of(dd_arm, method, 4000.0) for method in ("filter", "integrate")]
    for tracker in trackers:
        tracker.push(0, STILL)
    judged, plain = map(consistency_of, trackers)
    assert judged.size is not None and plain.size is None


def test_a_zero_there_is_not_is_no_matter_to_the_filter(dd_arm: Arm) -> None:
    for zero in ("each-rest", "first-rest"):
        assert tracker_of(dd_arm, "integrate", 4000.0, zero=zero).method == "integrate"
    with pytest.raises(ConfigError, match="frame_rate_hz is 0"):
        tracker_of(dd_arm, "integrate", 4000.0, None, 0.0)
