"""The time that a device has come to: its process is kept from running at times, and hardware never is."""

from collections.abc import Callable

#: What is caught up at once [s]: a few beats of the virtual device, which its memory and a tty hold many times.
_STEP_S = 0.02
#: … and of a longer lag this part, so that it is caught up however seldom the process runs.
_PART = 0.125


class DeviceTime:
    """Follows the host's clock, and after a lag of its own catches up step by step.

    What hardware sampled meanwhile would have been on the line in time. Were it made all at once, the device's
    memory would overflow before its host could read any of it: the device's lateness would count as the host's.

    Parameters
    ----------
    clock : callable
        Returns the host's time [s], never going back.
    """

    def __init__(self, clock: Callable[[], float]) -> None:
        self._clock = clock
        self._at_s = clock()

    def follow(self) -> float:
        """Go on, and return the time that the device has come to, on the host's clock [s]."""
        now_s = self._clock()
        lag_s = now_s - self._at_s
        step_s = max(_STEP_S, _PART * lag_s)
        self._at_s = now_s if lag_s <= step_s else self._at_s + step_s
        return self._at_s
