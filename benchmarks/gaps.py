"""Gaps within motions: how wrong the speeds are once samples come again, live and afterwards.

Of each motion of the bench a random while is lost. The live filter, with and without rivals, and the smoother see
the same readings.
"""

import argparse
import sys
from collections.abc import Mapping

import numpy as np
from rich.progress import track
from rich.table import Table

from arm.arm_file import load_arm
from arm.bench import Bench, Sensors, draw_sensor_errors, motions, rest_angles
from arm.counts import COUNT_M_S2
from arm.model import Floats
from arm.simulation import Motion
from limbcal.arguments import Parser, common_options
from limbcal.command import console, run_command
from tracking.kalman.batch_filter import BatchFilter
from tracking.kalman.multiple_model_filter import MultipleModelFilter
from tracking.model.decimation import Decimator
from tracking.model.noise import noise_of
from tracking.model.readings import Readings
from tracking.model.zero_velocity import window_frames
from tracking.smoother.smoother import Smoother

ARMS = ("dd-arm", "dd-arm-vertical", "spatial-arm")
_RATE_HZ, _FACTOR = 4000.0, 4
#: When the loss begins, and for how long it lasts [s].
_BEGIN_S, _LOST_S = (0.7, 2.0), (0.27, 1.5)
#: When speeds are looked at after it [s], and what is wrong [rad/s].
_LATER_S, _WRONG = (0.5, 1.0, 2.0), 0.1


def errors(name: str, seed: int) -> Mapping[str, Floats]:
    """Return, by filter, the speeds' largest error at each time after the gap [rad/s]."""
    arm, rng = load_arm(name), np.random.default_rng([seed, 99])
    sensors = Sensors(arm, draw_sensor_errors(arm, rng), _RATE_HZ, rng)
    motion = next(iter(motions(arm, Bench(_RATE_HZ, learning=1, evaluating=0), seed)))
    readings = sensors.counts(motion) * COUNT_M_S2
    frames = Decimator(_FACTOR, readings.shape[1]).push(readings)
    dt_s = _FACTOR / _RATE_HZ
    begin, lost = (round(rng.uniform(*span) / dt_s) for span in (_BEGIN_S, _LOST_S))
    frames[begin : begin + lost] = np.nan
    cell, n_cell = window_frames(dt_s)
    q = rest_angles(arm, np.zeros(arm.n_joint))
    found: dict[str, Floats] = {}
    for kind in (MultipleModelFilter, BatchFilter):
        follower = kind(arm, q, True, frames[: cell * n_cell], noise_of(readings[:1000], _RATE_HZ), _FACTOR, dt_s)
        states = follower.follow(frames).states
        found[kind.__name__] = later_errors(states, motion, begin + lost, dt_s)
    whole = Readings(frames, dt_s, 0.5 * dt_s, noise_of(readings[:1000], _RATE_HZ), _FACTOR)
    found["Smoother"] = later_errors(Smoother(arm, q, True).smooth(whole).states, motion, begin + lost, dt_s)
    return found


def later_errors(states: Floats, motion: Motion, end: int, dt_s: float) -> Floats:
    """Return the speeds' largest error at each time after a gap that ends at frame ``end`` [rad/s]."""
    dq = states[:, 1 : 3 * motion.dq.shape[1] : 3]
    wrong = np.abs(dq - motion.dq[_FACTOR // 2 :: _FACTOR][: len(dq)]).max(axis=1)
    return np.array([wrong[end + round(later / dt_s)] for later in _LATER_S])


def main(argv: list[str] | None = None) -> int:
    """Measure and show."""
    parser = Parser(prog="benchmarks.gaps", description=__doc__, parents=[common_options()])
    parser.add_argument("--seed", type=int, default=0, metavar="N", help="the first of the seeds (default: 0)")
    parser.add_argument("--motions", type=int, default=100, metavar="N", help="of each arm (default: 100)")
    parser.set_defaults(action=_measure_and_show)
    return run_command(parser, argv)


def _measure_and_show(arguments: argparse.Namespace) -> Mapping[str, object]:
    table = Table(title=f"share of {arguments.motions} motions whose speeds are wrong by more than {_WRONG} rad/s")
    for heading in ("arm", "filter", *(f"after {later:g} s" for later in _LATER_S)):
        table.add_column(heading)
    document: dict[str, object] = {}
    for name in ARMS:
        seeds = range(arguments.seed, arguments.seed + arguments.motions)
        of_all = [errors(name, seed) for seed in track(seeds, name, console=console)]
        for kind in of_all[0]:
            shares = np.mean([one[kind] > _WRONG for one in of_all], axis=0)
            table.add_row(name, kind, *(f"{100.0 * share:.0f} %" for share in shares))
            document[f"{name} {kind}"] = shares.tolist()
    console.print(table)
    return document


if __name__ == "__main__":
    sys.exit(main())
