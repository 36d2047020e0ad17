"""A motion of an arm with markers, with the recording that it was tracked from."""

from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
from scipy.spatial.transform import Rotation

from arm.arm_file import format_arm, load_arm
from arm.marker_positions import marker_positions
from arm.model import Base, Marker
from playback.trajectory import Floats

RATE_HZ, BEGIN_S, N_FRAME = 100.0, 2.0, 60
ARM = replace(
    load_arm("dd-arm"),
    base=Base((0.05, 0.0, -0.1), (0.2, 0.1, -0.3), "pelvis"),
    markers=(
        Marker("hip", 0, (0.02, 0.03, 0.05)),
        Marker("knee", 1, (0.3, 0.04, 0.0)),
        Marker("toe", 2, (0.2, 0.0, 0.1)),
    ),
)


@dataclass(frozen=True)
class TrackedMotion:
    """The files, and what is in them: joint values, and markers in frame 0 but for `off_m` of the toe's."""

    arm: Path
    motion: Path
    recording: Path
    q: Floats
    places: Floats


def written(folder: Path, off_m: tuple[float, float, float] = (0.0, 0.0, 0.0)) -> TrackedMotion:
    """Write an arm, a motion whose base moves, and a TRC in which the toe is off and the knee hidden at times.

    The toe is off by `off_m` along frame 0's axes; the knee is not seen in frames 20 to 29.
    """
    t = BEGIN_S + np.arange(N_FRAME) / RATE_HZ
    q = np.stack([0.4 * np.sin(4.0 * t), 0.8 * np.cos(3.0 * t)], axis=1)
    turn = Rotation.from_rotvec(np.outer(np.sin(t), [0.3, -0.2, 0.5]))
    place = np.stack([0.2 * t, np.sin(t), 0.9 + 0.0 * t], axis=1)
    places = marker_positions(ARM, q)
    places[:, 2] += off_m
    places[20:30, 1] = np.nan
    # frame 0 on the segment, the segment in the world
    on_segment = Rotation.from_euler("xyz", ARM.base.rotation_rad).apply(places.reshape(-1, 3))  # type: ignore[union-attr]
    on_segment = on_segment.reshape(places.shape) + np.array([0.05, 0.0, -0.1])
    world = np.stack([turn.apply(on_segment[:, m]) + place for m in range(3)], axis=1)
    table = np.column_stack([t, q, place, turn.as_quat(scalar_first=True)])
    motion = folder / "motion.csv"
    header = "t,q1,q2,base_x,base_y,base_z,base_qw,base_qx,base_qy,base_qz"
    np.savetxt(motion, table, delimiter=",", header=header, comments="", fmt="%.17g")
    recording = folder / "trial.trc"
    recording.write_text(trc(t, world), encoding="utf-8")
    arm = folder / "arm.toml"
    arm.write_text(format_arm(ARM), encoding="utf-8")
    return TrackedMotion(arm, motion, recording, q, places)


def trc(t: Floats, world: Floats, names: tuple[str, ...] = ("hip", "knee", "toe")) -> str:
    """Return the text of a TRC in metres; nothing stands where a marker was not seen."""
    n = len(t)
    lines = [
        "PathFileType\t4\t(X/Y/Z)\ttrial.trc",
        "DataRate\tCameraRate\tNumFrames\tNumMarkers\tUnits\tOrigDataRate\tOrigDataStartFrame\tOrigNumFrames",
        f"{RATE_HZ}\t{RATE_HZ}\t{n}\t{len(names)}\tm\t{RATE_HZ}\t1\t{n}",
        "Frame#\tTime\t" + "\t\t\t".join(names) + "\t\t",
        "\t\t" + "\t".join(f"{axis}{k + 1}" for k in range(len(names)) for axis in "XYZ"),
        "",
    ]
    for k in range(n):
        cells = ["" if np.isnan(x) else f"{x:.9f}" for x in world[k].ravel()]
        lines.append("\t".join([str(k + 1), f"{t[k]:.9g}", *cells]))
    return "\n".join([*lines, ""])
