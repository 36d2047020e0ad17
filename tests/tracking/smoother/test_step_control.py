"""Steps of passes, and their end."""

import pytest

from tracking.smoother.step_control import StepControl


def test_passes_that_get_nearer_go_all_the_way_and_end_at_a_fiftieth() -> None:
    steps = StepControl()
    for passes, moved in enumerate([1.0, 0.5, 0.1, 0.021], 1):
        assert not steps.judge(moved, -10.0 * passes) and not steps.converged
    assert not steps.judge(0.0147, 0.0)
    assert (steps.passes, steps.converged, steps.step) == (5, True, 1.0)


def test_passes_that_swing_are_halved_twice() -> None:
    steps, taken = StepControl(), []
    for passes in range(6):
        swings = steps.judge(1.0, 10.0 * passes)
        assert swings == (passes >= 2)
        taken.append(steps.step)
    assert taken == [1.0, 1.0, 0.5, 0.25, 0.25, 0.25] and not steps.converged


@pytest.mark.parametrize(("nats", "ends"), [(0.49, True), (0.51, False)])
def test_four_that_swing_and_are_as_likely_are_enough(nats: float, ends: bool) -> None:
    steps = StepControl()
    for passes in range(7):
        assert not steps.converged
        steps.judge(1.0, 2.0 * nats * (passes % 2))
    assert steps.converged == ends


def test_another_motion_or_other_readings_are_judged_anew() -> None:
    steps = StepControl()
    for _ in range(7):
        steps.judge(1.0, 0.0)
    steps.go_on()
    assert not steps.converged and steps.step == 0.25
    assert not steps.judge(1.0, 0.0)  # of what has changed no pass before says how far away it was
    steps.begin_anew()
    assert steps.step == 1.0
