"""The tilt of a walker's arms from accelerations alone, against what the sensors' maker finds with gyros as well.

Reads HumanInertialPose's recordings, one sensor on the upper arm and one on the forearm of either side.
"""

import argparse
import os
import sys
from pathlib import Path
from typing import NamedTuple

import numpy as np
from matplotlib.figure import Figure
from scipy.signal import butter, sosfilt, sosfiltfilt

from arm.arm_file import load_arm
from arm.kinematics import axis_frames, rotation_from_rpy
from arm.model import Arm, Floats
from limbcal.command import emit, say
from limbcal.errors import DataError, LimbcalError
from tracking.kalman.kalman_filter import KalmanTracker
from tracking.model.readings import Readings, ReadingsBuilder
from tracking.smoother.smoothed_frames import smooth_motion

ARM = Path(__file__).with_name("human-arm.toml")
DATA = Path(os.environ.get("LIMBCAL_DATA", Path(__file__).parents[1] / ".." / "shared" / "data"))
RATE_HZ = 60.0
SEGMENTS, SENSORS = ("upper arm", "forearm"), {"right": ("34", "30"), "left": ("26", "27")}


class Track(NamedTuple):
    """What a method says: "up" in each sensor's axes, (n, 2, 3), and the tilts' std, (n, 2) [rad]."""

    up: Floats
    std: Floats | None = None

    def misses(self, up: Floats) -> tuple[Floats, Floats]:
        """Return by how much tilt and direction of "up" are off, (n, 2) each [deg]."""
        sine = np.linalg.norm(np.cross(self.up, up), axis=2)
        return np.degrees(tilt_of(self.up) - tilt_of(up)), np.degrees(np.arctan2(sine, (self.up * up).sum(axis=2)))


def rms(values: Floats) -> float:
    """Return the root of the mean square."""
    return float(np.sqrt(np.mean(values**2)))


def tilt_of(up: Floats) -> Floats:
    """Return the angle from the vertical of each sensor's x, which lies along the segment [rad]."""
    tilt: Floats = np.arccos(np.clip(up[..., 0], -1.0, 1.0))
    return tilt


def read_side(folder: Path, side: str) -> tuple[Floats, Floats]:
    """Return accelerations, (n, 6) [m/s^2], and the maker's "up" in each sensor's axes, (n, 2, 3)."""
    accelerations, ups = [], []
    for number in SENSORS[side]:
        path = folder / "hipose" / f"example_calibration_xsens_00b45c{number}.csv"
        if not path.is_file():
            raise DataError(f"{path} is not there; expected HumanInertialPose's recording, see --data")
        table = np.loadtxt(path, delimiter=";", skiprows=5)
        w, x, y, z = table[:, 10:14].T  # turns sensor axes into earth axes, of which "up" is the third
        accelerations.append(table[:, 1:4])
        ups.append(np.stack([2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)], axis=1))
    return np.hstack(accelerations), np.stack(ups, axis=1)


def taken_for_gravity(readings: Floats) -> Track:
    """Return "up" as if nothing but gravity were felt."""
    felt = readings.reshape(-1, 2, 3)
    return Track(felt / np.linalg.norm(felt, axis=2, keepdims=True))


def of_joints(arm: Arm, q: Floats, covariance: Floats) -> Track:
    """Return what joint angles say, of whose covariance the diagonal may be all that is known."""
    axes = [rotation_from_rpy(*sensor.rotation_rad) for sensor in arm.sensors]

    def ups(at: Floats) -> Floats:
        T = axis_frames(arm, at)
        return np.stack([T[:, s.joint - 1, 2, :3] @ R for s, R in zip(arm.sensors, axes, strict=True)], axis=1)

    if covariance.ndim == 2:
        covariance = covariance[:, :, None] * np.eye(arm.n_joint)
    step = 1e-6 * np.eye(arm.n_joint)
    slope = np.stack([(tilt_of(ups(q + h)) - tilt_of(ups(q - h))) / 2e-6 for h in step], axis=2)
    return Track(ups(q), np.sqrt(np.einsum("ksi,kij,ksj->ks", slope, covariance, slope)))


def as_it_is(arm: Arm, readings: Readings, method: str) -> Track:
    """Return what the live filter or the smoother says, as it is."""
    if method == "smoother":
        found = smooth_motion(arm, readings, None)
        if (lacks := found.smoothed.discrepancy) is not None:
            sizes = f"base {lacks.base_std:.2g} m/s^2, sensors {lacks.lack_std:.2g} m/s^2, {lacks.memory_s:g} s"
            say(f"smoother: the model lacks: {sizes}")
        return of_joints(arm, found.frames.q, found.smoothed.variance[:, ::3])
    tracker = KalmanTracker(arm, RATE_HZ, None, RATE_HZ)
    frames = tracker.push(0, readings.values)[0] + tracker.flush()[0]
    say(f"filter: says that its readings {'contradict' if tracker.consistency().wrong else 'fit'} the arm")
    std = np.vstack([block.q_std for block in frames if block.q_std is not None])
    return of_joints(arm, np.vstack([block.q for block in frames]), std**2)


def tracks_of(arm: Arm, accelerations: Floats) -> dict[str, Track]:
    """Return what every method says; one that breaks down is named and left out."""
    builder = ReadingsBuilder(RATE_HZ, accelerations.shape[1], RATE_HZ)
    builder.push(accelerations)
    readings, first = builder.done(), accelerations[0]
    low_pass = butter(2, 1.0, fs=RATE_HZ, output="sos")
    tracks = {"readings": taken_for_gravity(accelerations)}
    tracks["low-passed"] = taken_for_gravity(sosfilt(low_pass, accelerations - first, axis=0) + first)
    tracks["low-passed twice"] = taken_for_gravity(sosfiltfilt(low_pass, accelerations, axis=0))
    for name in ("filter", "smoother"):
        try:
            tracks[name] = as_it_is(arm, readings, name)
        except (np.linalg.LinAlgError, LimbcalError) as error:
            say(f"{name}: breaks down ({error})")
    return tracks


def table_of(side: str, tracks: dict[str, Track], up: Floats) -> str:
    """Return a line a method: the errors of either segment [deg], and the share of the tilt's within 3 sigma."""
    lines = [f"{side:18}" + "".join(f"{name + ': rms, max, direction, 3σ':>40}" for name in SEGMENTS)]
    for name, track in tracks.items():
        (tilt, direction), line = track.misses(up), f"{name:18}"
        for s in (0, 1):
            line += f"{rms(tilt[:, s]):16.1f}{np.abs(tilt[:, s]).max():8.1f}{rms(direction[:, s]):8.1f}"
            if track.std is not None:
                line += f"{100.0 * np.mean(np.abs(tilt[:, s]) < 3.0 * np.degrees(track.std[:, s])):6.0f} %"
            else:
                line += f"{'-':>8}"  # it claims nothing
        lines.append(line)
    return "\n".join(lines)


def draw(path: Path, tracks: dict[str, Track], up: Floats) -> None:
    """Draw both segments' tilt over time, and below by how much it is missed."""
    figure = Figure(figsize=(11.0, 6.4), layout="constrained")
    axes, t = figure.subplots(2, 2, sharex=True, sharey="row"), np.arange(len(up)) / RATE_HZ
    for s, (above, below) in enumerate(axes.T):
        for name, colour in (("low-passed", "0.65"), ("smoother", "C0")):
            track, off = tracks[name], tracks[name].misses(up)[0][:, s]
            tilt = np.degrees(tilt_of(track.up[:, s]))
            above.plot(t, tilt, color=colour, lw=1.2, label=name)
            below.plot(t, off, color=colour, lw=1.2, label=f"{name}: {rms(off):.1f}° rms")
            if name.startswith("smoother") and track.std is not None:
                band = 3.0 * np.degrees(track.std[:, s])
                above.fill_between(t, np.fmax(tilt - band, 0.0), tilt + band, alpha=0.15, lw=0, label="its 3σ")
        above.plot(t, np.degrees(tilt_of(up))[:, s], "k", lw=1.2, label="maker's quaternion")
        above.set(title=f"right {SEGMENTS[s]}", ylabel="tilt from the vertical [°]")
        below.set(xlabel="time [s]", ylabel="error of the tilt [°]", ylim=(-65, 28))
        below.legend(fontsize=8, loc="lower left")
    axes[0, 0].legend(fontsize=8, loc="upper left")
    figure.savefig(path, dpi=110)


def main(argv: list[str] | None = None) -> int:
    """Print the table and draw the figure; return the exit code."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--data", type=Path, default=DATA, help="the folder that holds hipose/ (../shared/data)")
    parser.add_argument("--out", type=Path, help="draw the right arm's figure here")
    arguments, arm = parser.parse_args(argv), load_arm(ARM)
    try:
        for side in SENSORS:
            accelerations, up = read_side(arguments.data, side)
            tracks = tracks_of(arm, accelerations)
            emit(table_of(side, tracks, up))
            if arguments.out is not None and side == "right":
                draw(arguments.out, tracks, up)
    except LimbcalError as error:
        say(f"error: {error}")
        return error.exit_code
    return 0


if __name__ == "__main__":
    sys.exit(main())
