"""Processor time of a minute of 40 markers at 100 Hz: the fit of a limb and its inverse kinematics.

    OMP_NUM_THREADS=1 python -m benchmarks.marker_minute [--json]

A simulated arm and leg whose markers wander by 3 mm an axis. Kernels are compiled beforehand. Times are the
processor's; a file's reading and writing is not among them.
"""

import argparse
import sys
import time
from collections.abc import Sequence

import numpy as np

from benchmarks.simulated_people.person import person
from fitter.limb.limb_calibration import calibrate
from fitter.limb.tracking import track_limb
from fitter.limb.warm_up import warm_up
from fitter.limb.written_arm import calibrated_arm
from limbcal.arguments import Parser, common_options
from limbcal.command import Document, emit, run_command

SECONDS, RATE_HZ, NOISE_M = 60, 100.0, 3e-3
#: Markers a segment, so that with the base's four and the landmarks there are 40.
CLUSTERS = {"human-arm-right": 10, "human-leg-right": 9}


def timed(preset: str, seconds: float = SECONDS) -> dict[str, float]:
    """Return how many markers a limb has, the processor time of its fit and tracking [s], and their rms [mm]."""
    n = int(seconds * RATE_HZ)
    truth = person(preset, seed=100, n=n, noise_m=NOISE_M, rate_hz=RATE_HZ, cluster=CLUSTERS[preset])
    began = time.process_time()
    fit = calibrate(truth.recordings, truth.marker_set, preset)
    fitted = time.process_time()
    (tracked,) = track_limb(calibrated_arm(fit, None), truth.recordings)
    ended = time.process_time()
    return {
        "markers": tracked.distance_m.shape[1],
        "fit_s": fitted - began,
        "track_s": ended - fitted,
        "rms_mm": 1e3 * float(np.sqrt(np.nanmean(tracked.distance_m**2))),
    }


def show(options: argparse.Namespace) -> Document:
    """Measure, and print a table."""
    warm_up()
    found = {preset: timed(preset) for preset in CLUSTERS}
    if not options.json:
        emit("| limb | markers | fit | tracking | off, rms |")
        for preset, one in found.items():
            emit(
                f"| {preset} | {one['markers']} | {one['fit_s']:.1f} s | {one['track_s']:.1f} s "
                f"| {one['rms_mm']:.1f} mm |"
            )
    return {"seconds": SECONDS, "rate_hz": RATE_HZ, "limbs": found}


def main(argv: Sequence[str] | None = None) -> int:
    """Run the benchmark."""
    parser = Parser(prog="python -m benchmarks.marker_minute", description=__doc__, parents=[common_options()])
    parser.set_defaults(action=show)
    return run_command(parser, argv)


if __name__ == "__main__":
    sys.exit(main())
