"""Going through what the fitter's commands do, on hardly any data, so that all kernels are compiled."""

from dataclasses import replace
from itertools import islice

import numpy as np

from arm.arm_file import load_arm
from arm.bench import Bench, Sensors, draw_sensor_errors, motions
from arm.counts import COUNT_M_S2
from arm.model import Control
from fitter.data.gaps import Gap
from fitter.data.motions import Measured
from fitter.data.raw import RawRun
from fitter.data.trials import to_trials
from fitter.diagnosis.warm_up import warm_up as diagnosis_warm_up
from fitter.dynamics.fit import fit_dynamics
from fitter.limb.warm_up import warm_up as limb_warm_up
from fitter.live import warm_up as live
from fitter.marker_diagnosis.warm_up import warm_up as marker_warm_up
from fitter.reading_diagnosis.warm_up import warm_up as reading_warm_up
from fitter.sensing.track import Method, track_run
from tracking.model.readings import ReadingsBuilder
from tracking.smoother.discrepancy_smoother import DiscrepancySmoother

#: Of the readings that are tracked; a motion, and samples lost in it.
_BENCH = Bench(rate_hz=2000.0, trial_s=2.0, learning=1, evaluating=0)
_LOST_ROW, _LOST = 2000, 40
#: Of the frames in which what the model lacks is sought, too.
_DOUBTED_HZ = 50.0
_METHODS: tuple[Method, ...] = ("integrate", "filter", "smooth")


def compile_all() -> None:
    """Calibrate, diagnose and track an arm of no interest, from a stream and from files.

    What tracks comes last: `limbd compile` beside it begins there, and nothing is compiled twice.
    """
    limb_warm_up()
    marker_warm_up()
    diagnosis_warm_up()
    reading_warm_up()
    arm = load_arm("dd-arm")
    rng = np.random.default_rng(0)
    sensors = Sensors(arm, draw_sensor_errors(arm, rng), _BENCH.rate_hz, rng)
    (motion,) = islice(motions(arm, _BENCH, seed=0), 1)
    kept = np.r_[:_LOST_ROW, _LOST_ROW + _LOST : len(motion.t)]
    readings = (COUNT_M_S2 * sensors.counts(motion)[kept]).astype(np.float64)
    run = RawRun("warm-up", _BENCH.rate_hz, motion.t[kept], readings, (Gap(_LOST_ROW, _LOST),))
    columns = {"q": motion.q, "dq": motion.dq, "ddq": motion.ddq, "tau": motion.tau}
    trials = to_trials([Measured("warm-up", "warm-up", 0, motion.t, columns)])
    fit_dynamics(replace(arm, control=Control("measured")), trials, seed=0, examine=False)
    live.warm_up()
    for method in _METHODS:
        track_run(run, arm, motion.q[0], 1000.0, method)
    builder = ReadingsBuilder(_BENCH.rate_hz, readings.shape[1], _DOUBTED_HZ)
    builder.push(readings[:_LOST_ROW])
    DiscrepancySmoother(arm, motion.q[0], True).smooth(builder.done())
