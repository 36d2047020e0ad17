"""A filter that begins anew after a gap, from one of the ways of moving that explain what is read then."""

from arm.model import Floats
from tracking.kalman.batch_filter import BatchFilter


class RestartedFilter(BatchFilter):
    """A live filter that may be told where its readings are best linearised; copies of it follow other ways."""

    def regain(self, readings: Floats) -> None:
        """After a gap, hold the motion to be what it may have become until the middle of some readings."""
        kf, n = self._kf, len(readings)
        kf.x, kf.P = kf.x.copy(), kf.P.copy()
        self.loss.regain(0.5 * (n - 1) * self._dt, kf.x, kf.P)
        self.loss.find()
        self.misfit, self._last, self._begun = 0.0, readings[-1], True

    def explained(self, readings: Floats, at: Floats) -> tuple[Floats, float]:
        """Return the state that the mean of readings leads to, linearised in the state ``at``, and its misfit.

        Nothing is taken in. The misfit is the innovation's squared size.
        """
        kf = self._kf
        x, P = kf.x, kf.P
        squared = self._take_mean(readings, at)
        found, kf.x, kf.P = kf.x, x, P
        return found, squared

    def suppose(self, readings: Floats, at: Floats) -> None:
        """Take in the mean of readings, linearised in the state ``at``, and go on to the last of them."""
        self.misfit += self._take_mean(readings, at)
        for _ in range(len(readings) // 2):
            self._kf.predict()

    def _take_mean(self, readings: Floats, at: Floats) -> float:
        noise = self._moving_noise / len(readings)
        return self._correct(readings.mean(axis=0), at, self._n_channel, noise)
