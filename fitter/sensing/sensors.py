"""Sensors calibrated from ordinary motions: what `fitter sensors` finds, and what it says of it."""

import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

from arm.model import Arm, Floats
from fitter.data.raw import RawRun
from fitter.search.fitted_parameter import FittedParameter
from tracking.model.initial_state import MountingPrior
from tracking.smoother.self_calibration import SensorCalibration, calibrate_sensors

#: The constants of a sensor need no more frames a second than motions do.
FRAME_RATE_HZ = 1000.0


@dataclass(frozen=True)
class SensorsFit:
    """What was learnt of the sensors.

    Attributes
    ----------
    calibration : SensorCalibration
    samples : int
        Readings of every sensor that it was learnt from.
    seconds : float
        Time that it took.
    """

    calibration: SensorCalibration
    samples: int
    seconds: float

    @property
    def arm(self) -> Arm:
        """The arm with its sensors as they were found."""
        return self.calibration.arm

    def parameters(self) -> dict[str, dict[str, FittedParameter]]:
        """Return the numbers of every sensor, by the sensors' names."""
        found: dict[str, dict[str, FittedParameter]] = {}
        for one in self.calibration.estimates:
            number = FittedParameter(one.value, one.std, one.unit, one.revealed)
            found.setdefault(one.sensor, {})[one.name] = number
        return found

    def _lengths(self) -> dict[str, object]:
        """Return the lengths that the motion revealed, for a JSON document."""
        found: dict[str, object] = {}
        for i, name in sorted(self.calibration.lengths):
            joint = self.arm.joints[i]
            length = FittedParameter(getattr(joint, name), joint.length_std_m or 0.0, "m", True)
            found[f"{name.removesuffix('_m')}{i + 1}"] = length.document()
        return {"lengths": found}

    def document(self) -> dict[str, object]:
        """Return what `fitter sensors --json` prints, but for where the arm was written."""
        found = self.calibration
        lacks = found.discrepancy
        return {
            "sensors": {
                sensor: {name: number.document() for name, number in numbers.items()}
                for sensor, numbers in self.parameters().items()
            },
            "axes": dict(found.axes),
            "not_revealed": list(found.hidden),
            "passes": found.passes,
            "converged": found.converged,
            "doubted": found.doubted,
            **self._lengths(),
            **({} if lacks is None else {"discrepancy_m_s2": lacks.lack_std, "base_m_s2": lacks.base_std}),
            **({} if lacks is None or not self.arm.gyroscopes else {"discrepancy_rad_s": lacks.rate_lack_std}),
            "samples": self.samples,
            "seconds": self.seconds,
        }


def fit_sensors(
    arm: Arm,
    runs: Sequence[RawRun],
    initial_q_rad: Floats | None,
    prior: MountingPrior,
    *,
    highpass_hz: float | None = None,
    clock: Callable[[], float] = time.perf_counter,
    progress: Callable[[int], None] | None = None,
) -> SensorsFit:
    """Find what the sensors read and where they sit, from motions of the arm that need not be known.

    Parameters
    ----------
    arm : Arm
    runs : sequence of RawRun
        Each begins with a rest. Of gyroscopes those count that all runs have.
    initial_q_rad : (n_joint,) or None
        Where the arm rests when a run begins; None asks gravity.
    prior : MountingPrior
        How far off the sensors may be.
    highpass_hz : float, optional
        All sensors are AC-coupled with about this corner, which is to be found.
    clock : callable, optional
    progress : callable, optional
        Called with the number of passes after each.

    Raises
    ------
    DataError
        If a run is too short, or no motion of such an arm explains it at all.
    """
    began = clock()
    if highpass_hz is not None:
        coupled = tuple(replace(sensor, highpass_hz=highpass_hz) for sensor in arm.sensors)
        arm = replace(arm, sensors=coupled)
    gyros = set.intersection(*(set(run.gyros) for run in runs))
    arm = arm.with_gyroscopes(gyros)
    readings = [run.with_gyros(gyros).readings(FRAME_RATE_HZ) for run in runs]
    found = calibrate_sensors(arm, readings, initial_q_rad, prior, progress)
    return SensorsFit(found, sum(len(run.t) for run in runs), clock() - began)
