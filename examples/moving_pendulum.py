"""A pendulum's angles from two accelerometers, against cameras and gyros; the gyros are used if asked for.

Reads RepoIMU's recordings (agnieszkaszczesna/RepoIMU on GitHub, folder Pendulum): the upper two of three links.
Lengths and sensors are found from the first trials of each way in which they were mounted, beginning with lengths
that are wrong on purpose; then all trials are tracked.
"""

import argparse
import sys
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from rich.progress import track

from arm.arm_file import load_arm
from arm.model import Arm, Floats, Vector3
from limbcal.command import console, emit, say
from limbcal.errors import DataError, LimbcalError
from tracking.kalman.kalman_filter import KalmanTracker
from tracking.model.initial_state import MountingPrior
from tracking.model.readings import Readings, ReadingsBuilder
from tracking.smoother.self_calibration import calibrate_sensors
from tracking.smoother.smoothed_frames import smooth_motion

ARM = Path(__file__).with_name("repo-pendulum.toml")
#: Rate of the inertial sensors [Hz]; each reading is held in the file until the next.
RATE_HZ = 90.0
#: How well sensors are placed and turned by hand.
PRIOR = MountingPrior(turn_rad=np.deg2rad(5.0), place_m=0.04)
#: Trials, and those of them that are learnt from: between tests 02 and 03 the sensors were mounted anew.
SETS = (
    ("0[2]", ("Test02a_Trial1", "Test02b_Trial1")),
    ("0[3-8]", ("Test03_Trial1", "Test03_Trial2", "Test03_Trial3")),
)
#: Offsets of the two clocks that are tried [s], and what is omitted at both ends.
SHIFTS_S, END_S = np.arange(-0.1, 0.101, 0.005), 1.0
#: Weights of Cauchy's distribution: their constant, in medians of the absolute error (R. A. Maronna, R. D. Martin,
#: V. J. Yohai, *Robust Statistics*, 2006: 95 % as efficient as least squares on normal errors), and their rounds.
CAUCHY, ROUNDS = 2.385 / 0.6745, 10


class Trial(NamedTuple):
    """One trial: accelerations (n, 6), rates of the gyros (n, 6), angles by the cameras (n, 2)."""

    name: str
    t: Floats
    accelerations: Floats
    rates: Floats
    q: Floats

    def readings_of(self, arm: Arm) -> Floats:
        """Return what the sensors of an arm read, (n, 6) or with their gyroscopes (n, 12)."""
        return np.hstack([self.accelerations, self.rates])[:, : arm.n_channel]

    def decimated(self, arm: Arm) -> Readings:
        """Return the readings as the trackers take them."""
        builder = ReadingsBuilder(RATE_HZ, arm.n_channel, RATE_HZ, 3 * len(arm.gyroscopes))
        builder.push(self.readings_of(arm))
        return builder.done()


def read_segment(path: Path) -> Floats:
    """Return time, quaternion of the cameras, acceleration, rate: (n, 11), without rows that lack any."""
    if not path.is_file():
        raise DataError(f"{path} is not there; expected RepoIMU's folder Pendulum, see --data")
    table = np.genfromtxt(path, delimiter=";", skip_header=2)[:, :11]
    seen = ~np.isnan(table).any(axis=1) & (np.linalg.norm(table[:, 1:5], axis=1) > 0.5)
    rows: Floats = table[seen]
    return rows


def at_changes(t: Floats, time: Floats, values: Floats) -> Floats:
    """Return held values at other times, as lines between the instants at which they changed."""
    new = np.concatenate([[True], np.any(np.diff(values, axis=0) != 0.0, axis=1)])
    return np.column_stack([np.interp(t, time[new], column[new]) for column in values.T])


def angle_of(quaternion: Floats) -> Floats:
    """Return the angle about the main axis of turning, from the mean of the first rows on (n,)."""
    w0, v0 = quaternion[:20, 0].mean(), quaternion[:20, 1:].mean(axis=0)
    w, v = quaternion[:, 0], quaternion[:, 1:]
    scalar = w * w0 + v @ v0
    vector = w0 * v - w[:, None] * v0 - np.cross(v, v0)
    vector *= np.where(scalar < 0.0, -1.0, 1.0)[:, None]
    axis = np.linalg.svd(vector, full_matrices=False)[2][0]
    angle: Floats = np.unwrap(2.0 * np.arctan2(vector @ axis, np.abs(scalar)))
    return angle


def read_trial(folder: Path, name: str) -> Trial:
    """Read the upper two links of a trial; the sign of each angle is that which gravity shows."""
    segments = [read_segment(folder / f"Pendulum_{name}_Segment_{k}.csv") for k in (1, 2)]
    t = np.arange(max(s[0, 0] for s in segments), min(s[-1, 0] for s in segments), 1.0 / RATE_HZ)
    readings, rates = (np.hstack([at_changes(t, s[:, 0], s[:, k : k + 3]) for s in segments]) for k in (5, 8))
    links = np.column_stack([np.interp(t, s[:, 0], angle_of(s[:, 1:5])) for s in segments])
    for k in (0, 1):
        felt = np.unwrap(np.arctan2(readings[:, 3 * k + 1], readings[:, 3 * k]))
        links[:, k] *= -np.sign(np.corrcoef(felt, links[:, k])[0, 1])
    return Trial(name, t - t[0], readings, rates, np.column_stack([links[:, 0], links[:, 1] - links[:, 0]]))


def misses(trial: Trial, reference: Floats, q: Floats) -> Floats:
    """Return by how much reference angles differ, after the one shift of the clocks that fits best (n, 2)."""
    inside, found = inside_of(trial), []
    for shift in SHIFTS_S:
        moved = np.column_stack([np.interp(trial.t[inside] - shift, trial.t, column) for column in reference.T])
        found.append(moved - q[inside])
    return min(found, key=lambda off: float(np.abs(off).mean()))


def at_level(trial: Trial) -> Floats:
    """Return the angles that the gyros turn by, at the level that the cameras show (n, 2).

    From instant to instant the gyros are the better reference, over the whole trial the cameras: where they stand
    still or jump, they count little. A gyro's drift is a parabola, found by weights of Cauchy's distribution.
    """
    inside, links = inside_of(trial), np.empty_like(trial.q)
    powers = np.vander(trial.t / trial.t[-1], 3)
    for k, cameras in enumerate(np.cumsum(trial.q, axis=1).T):
        turned = turned_by_gyro(trial, k, cameras)
        found = []
        for shift in SHIFTS_S:
            drift = np.interp(trial.t - shift, trial.t, cameras) - turned
            weight = np.ones(np.count_nonzero(inside))
            for _ in range(ROUNDS):
                root = np.sqrt(weight)
                parabola = np.linalg.lstsq(powers[inside] * root[:, None], drift[inside] * root, rcond=None)[0]
                left = np.abs(drift - powers @ parabola)[inside]
                weight = 1.0 / (1.0 + (left / (CAUCHY * np.median(left))) ** 2)
            found.append((float(np.median(left)), parabola))
        links[:, k] = turned + powers @ min(found, key=lambda one: one[0])[1]
    return np.column_stack([links[:, 0], links[:, 1] - links[:, 0]])


def inside_of(trial: Trial) -> NDArray[np.bool_]:
    """Say which instants are neither in the first nor in the last second, (n,)."""
    return (trial.t > END_S) & (trial.t < trial.t[-1] - END_S)


def turned_by_gyro(trial: Trial, link: int, like: Floats) -> Floats:
    """Return by which angle a link turned by its gyro (n,), about the same way round as another one says (n,)."""
    rate = trial.rates[:, 3 * link + 2] - trial.rates[:30, 3 * link + 2].mean()
    turned = np.cumsum(rate) / RATE_HZ
    same: Floats = turned * np.sign(np.corrcoef(turned, like)[0, 1])
    return same


def off_gyros(trial: Trial, q: Floats) -> Floats:
    """Return by how much both links' angles differ from integrated rates, but for the gyros' drift (2,) [deg].

    The drift of an angle is a parabola: the gyros' zero, and how it wanders.
    """
    links, found = np.cumsum(q, axis=1), []
    for k in (0, 1):
        turned, shifts = turned_by_gyro(trial, k, links[:, k]), []
        for shift in range(-8, 9):
            off = np.roll(links[:, k], shift) - turned
            off -= np.polyval(np.polyfit(trial.t, off, 2), trial.t)
            shifts.append(float(np.degrees(np.abs(off[90:-90]).mean())))
        found.append(min(shifts))
    return np.array(found)


def vector(values: Floats) -> Vector3:
    """Return three numbers as an arm file has them."""
    x, y, z = (float(value) for value in values)
    return x, y, z


def wrong_by(arm: Arm, share: float) -> Arm:
    """Return an arm whose lengths and places are wrong by a share."""
    sensors = [replace(s, position_m=vector(np.multiply(1.0 + share, s.position_m))) for s in arm.sensors]
    length = arm.joints[0].a_m
    joint = replace(arm.joints[0], a_m=(1.0 + share) * length, length_std_m=abs(share) * length)
    return replace(arm, joints=(joint, *arm.joints[1:]), sensors=tuple(sensors))


def levelled(arm: Arm, first: Floats) -> Arm:
    """Return an arm whose sensors are turned about z as its first reading (n_channel,) shows while it hangs."""
    turns = [np.pi - np.arctan2(first[3 * k + 1], first[3 * k]) for k in (0, 1)]
    sensors = [replace(s, rotation_rad=(0.0, 0.0, float(a))) for s, a in zip(arm.sensors, turns, strict=True)]
    return replace(arm, sensors=tuple(sensors))


def tracked(arm: Arm, trial: Trial, method: str) -> tuple[Floats, Floats]:
    """Return the angles by the smoother or the live filter, and their standard deviations, (n, 2) each."""
    if method == "filter":
        tracker = KalmanTracker(arm, RATE_HZ, np.zeros(2), RATE_HZ)
        frames = tracker.push(0, trial.readings_of(arm))[0] + tracker.flush()[0]
    else:
        frames = [smooth_motion(arm, trial.decimated(arm), np.zeros(2)).frames]
    claims = [block.q_std for block in frames if block.q_std is not None]
    return np.vstack([block.q for block in frames]), np.vstack(claims)


def run(arm: Arm, folder: Path, pattern: str, learnt: Sequence[str], method: str) -> None:
    """Calibrate, track all trials of one set, and print how far they are off."""
    paths = sorted(folder.glob(f"Pendulum_Test{pattern}*_Segment_1.csv"))
    names = [path.name.removeprefix("Pendulum_").removesuffix("_Segment_1.csv") for path in paths]
    known = [read_trial(folder, name).decimated(arm) for name in learnt]
    arm = levelled(arm, known[0].first_mean)
    found = calibrate_sensors(arm, known, np.zeros(2), PRIOR)
    length, places = found.arm.joints[0], [s.position_m[0] for s in found.arm.sensors]
    emit(f"length {length.a_m:.4f} +- {length.length_std_m:.4f} m, sensors at {places[0]:.4f}, {places[1]:.4f} m")
    heads = ("off the cameras [deg]", "within 3 std [%]", "off gyros, levelled", "within 3 std [%]")
    heads = (*heads, "off gyros", "cameras off gyros", "… off levelled ones")
    emit(f"{'trial':16}" + "".join(f"{head:>23}" for head in heads))
    rows = []
    for name in track(names, "tracking", console=console, transient=True):
        trial = read_trial(folder, name)
        q, std = tracked(found.arm, trial, method)
        row = judged(trial, q, std)
        rows.append(row)
        emit(line(name, row))
    emit(line("mean", np.mean(rows, axis=0)))


def judged(trial: Trial, q: Floats, std: Floats) -> list[Floats]:
    """Return what a line of the table says of angles and their standard deviations, (n, 2) each."""
    row = []
    for reference in (trial.q, at_level(trial)):
        off = misses(trial, reference, q)
        within = 100.0 * np.mean(np.abs(off) < 3.0 * std[inside_of(trial)], axis=0)
        row += [np.degrees(np.abs(off).mean(axis=0)), within]
    cameras = np.degrees(np.abs(misses(trial, trial.q, at_level(trial))).mean(axis=0))
    return [*row, off_gyros(trial, q), off_gyros(trial, trial.q), cameras]


def line(name: str, row: Sequence[Floats]) -> str:
    """Return a line of the table."""
    digits = (2, 0, 2, 0, 2, 2, 2)
    cells = [f"{a:.{places}f}, {b:.{places}f}" for (a, b), places in zip(row, digits, strict=True)]
    return f"{name:16}" + "".join(f"{cell:>23}" for cell in cells)


def main(argv: list[str] | None = None) -> int:
    """Print the table and return the exit code."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--data", type=Path, required=True, help="RepoIMU's folder Pendulum")
    parser.add_argument("--wrong-by", type=float, default=0.2, help="of the lengths at first (0.2)")
    parser.add_argument("--method", choices=("smooth", "filter"), default="smooth", help="that tracks all trials")
    parser.add_argument("--gyros", action="store_true", help="use the gyros too")
    arguments = parser.parse_args(argv)
    try:
        arm = wrong_by(load_arm(ARM), arguments.wrong_by)
        if arguments.gyros:
            arm = arm.with_gyroscopes([sensor.name for sensor in arm.sensors])
        for pattern, learnt in SETS:
            run(arm, arguments.data, pattern, learnt, arguments.method)
    except LimbcalError as error:
        say(f"error: {error}")
        return error.exit_code
    return 0


if __name__ == "__main__":
    sys.exit(main())
