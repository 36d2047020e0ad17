"""UTC of a device tick: the host's clock says when the stream began, the device's how far it has come."""


class DeviceClock:
    """Tells the time of a sample from the device's ticks.

    Parameters
    ----------
    tick_hz : float
    first_ticks : int
        Device clock at the first sample.
    first_utc_ns : int
        UTC [ns] at the first sample.
    """

    def __init__(self, tick_hz: float, first_ticks: int, first_utc_ns: int) -> None:
        self._tick_hz = tick_hz
        self._first_ticks = first_ticks
        self._first_utc_ns = first_utc_ns

    def utc_ns(self, ticks: int) -> int:
        """Return UTC [ns] at a tick."""
        return self._first_utc_ns + round((ticks - self._first_ticks) * 1e9 / self._tick_hz)
