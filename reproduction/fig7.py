"""Fig. 7: the real arm's motions, as its accelerometers show them."""

import numpy as np

from reproduction.experiment import Experiment, Grid, Picture, Settings
from reproduction.motion_pair import angle_errors, picture_of
from reproduction.table2 import bench_of


def run(settings: Settings) -> Experiment:
    """Follow the bench's motions by its sensors and hold the angles against the true ones."""
    settings.progress("fig7: the smoother follows the readings")
    bench = bench_of(settings)
    settings.progress("fig7: double integration follows the readings")
    integrated = bench_of(settings, "integrate")
    errors = {
        "plain: double integration": angle_errors(integrated.true, [trial.q for trial in integrated.sensed]),
        "ours: smoother": angle_errors(bench.true, [trial.q for trial in bench.sensed]),
    }
    last = np.rad2deg(np.abs(bench.sensed[-1].q[-1] - bench.true[-1].q[-1]))
    return Experiment(
        name="fig7",
        title="Fig. 7: the real arm's motions, captured by four accelerometers",
        assumptions=(
            "The paper's arm is real; ours is the standard bench: dd-arm under law (5) at 9.5 / -9.5, "
            f"{len(bench.sensed)} motions of 6.75 s on one clock, sensors with 0.02 m/s² of noise and of offset "
            "(rms) and 16 bits.",
            "Nothing is known of the arm but its joints' kinds, its sensors' places, its control and where it "
            "rests at first. The angles are never measured otherwise, and never set right from outside.",
            "The paper shows these motions without saying how true they are.",
        ),
        grids=(
            Grid(
                "Captured angles against the true ones [deg]",
                ("method", "learning, mean", "learning, max", "evaluating, mean", "evaluating, max"),
                tuple((name, *found.cells()) for name, found in errors.items()),
            ),
        ),
        pictures=(
            Picture(
                picture_of(bench.true, [trial.q for trial in bench.sensed], ("true", "captured")),
                "The real arm's angles: as they were, and as four accelerometers and the smoother show them.",
            ),
        ),
        findings=(
            f"Of {len(bench.sensed)} motions {bench.recognised} were seen to begin and end.",
            f"At the end of the last motion the angles are off by {', '.join(f'{x:.2f}°' for x in last)}: in the "
            "horizontal plane nothing but what the sensors themselves add up says where joint 1 points.",
        ),
        document={
            "motions": len(bench.sensed),
            "recognised": bench.recognised,
            "angle_error_deg": {name: found.document() for name, found in errors.items()},
        },
    )
