"""Whatever happens to a line, samples have their numbers, and no clock is blamed that is right."""

import numpy as np
import pytest

from daemon.virtual_device.fault_schedule import Fault
from tests.daemon.line_histories import Heard, heard
from tests.soak import Long


def _misplaced(found: Heard) -> list[int]:
    """Return from where on samples have another number than they bear, though nothing inexact is said."""
    inexact = {gap.sample0 + gap.samples for gap in found.gaps if not gap.exact}
    number = np.concatenate([np.arange(first, first + len(borne)) for first, borne in found.runs])
    off = np.concatenate([borne for _, borne in found.runs]) - number
    assert off[0] == 0 and np.all(np.diff(number) > 0)
    return [at for at in (number[1:][np.diff(off) != 0]).tolist() if at not in inexact]


@pytest.mark.parametrize("part", range(4))
def test_what_is_called_exact_is_whatever_happens_to_the_line(part: int, long: Long) -> None:
    n_history = long.of(500, 6)
    misplaced, blamed = {}, []
    for seed in range(part * n_history, (part + 1) * n_history):
        found = heard(seed)
        if places := _misplaced(found):
            misplaced[seed] = found.faults, places
        restarted = any(fault.kind == "restart" for fault in found.faults)
        if not restarted and any("clock" in gap.why for gap in found.gaps):
            blamed.append((seed, found.faults))
    long.note(f"{n_history} histories of a line: {len(misplaced)} misplaced, {len(blamed)} times the clock blamed")
    assert misplaced == {} and blamed == []


@pytest.mark.parametrize("seconds", [0.6, 1.2, 2.2])
def test_a_silent_device_numbers_its_answers_and_loses_samples_alone(seconds: float) -> None:
    found = heard(1, (Fault("silent", 1.0, seconds, 0.0, None),))
    assert [(gap.why, gap.exact) for gap in found.gaps] == [("the device was silent", True)]
    assert _misplaced(found) == []


@pytest.mark.parametrize("start_s", [0.5, 1.7])
def test_a_device_without_power_for_longer_than_it_ran_was_restarted(start_s: float) -> None:
    """When it is started its clock shows more than before, because it waited for that."""
    found = heard(5, (Fault("restart", start_s, 2.2, 0.0, None),))
    (gap,) = found.gaps
    assert (gap.why, gap.exact) == ("the device was restarted", False)
    last, borne = found.runs[-1]
    assert abs(int(borne[0]) - last) < 0.05 * 4000  # as far as the host knows when it heard the device
