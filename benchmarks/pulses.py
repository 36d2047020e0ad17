"""Known torque pulses hidden in measured runs: how many `fitter diagnose` names, and what pushes it names besides.

    python -m benchmarks.pulses FOLDER --runs acrobot

FOLDER holds the runs of DFKI's double pendulum with pulses (columns ``tau_pert1``, ``tau_pert2`` of their own).
The command is given the measured torque less the pulses; the last runs are held back.
"""

import argparse
import sys
import tempfile
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from arm.model import Floats
from benchmarks.diagnosed import Found, by_command

ARM = Path(__file__).parents[1] / "examples" / "dfki-pendulum.toml"
COLUMNS = "t=time,q=pos_meas{j},tau=tau_meas{j}-tau_pert{j}"
N_JOINT = 2
#: A pulse of at least this size [N m] is asked for; found within these of its start [s] and of its size.
LEAST, NEAR_S, NEAR_SIZE = 0.35, 0.05, 0.3
#: What is smaller is no part of a pulse [N m].
_NOTHING = 0.02


@dataclass(frozen=True)
class Push:
    """A pulse of torque in a run, hidden or named.

    Attributes
    ----------
    run : str
    joint : int
        From 1.
    start_s, duration_s : float [s]
        At half its size.
    torque_N_m : float [N m]
    """

    run: str
    joint: int
    start_s: float
    duration_s: float
    torque_N_m: float

    def overlaps(self, other: "Push") -> bool:
        """Say whether another one is at the same joint at the same time."""
        begin = max(self.start_s, other.start_s)
        end = min(self.start_s + self.duration_s, other.start_s + other.duration_s)
        return (self.run, self.joint) == (other.run, other.joint) and begin < end

    def is_like(self, other: "Push") -> bool:
        """Say whether it begins and is as large as another one, as nearly as is asked."""
        near = abs(self.start_s - other.start_s) <= NEAR_S
        return near and abs(self.torque_N_m / other.torque_N_m - 1.0) <= NEAR_SIZE

    def __str__(self) -> str:
        place = f"{self.run} joint {self.joint}"
        return f"{place}  {self.start_s:.2f} s for {self.duration_s:.2f} s, {self.torque_N_m:+.2f} N m"


@dataclass(frozen=True)
class Score:
    """What was found of the pulses that are asked for, and what else was named."""

    asked: list[Push]
    found: list[Push]
    false: list[Push]
    joint_s: float

    @classmethod
    def of(cls, hidden: Sequence[Push], named: Sequence[Push], joint_s: float) -> "Score":
        """Return the score of what was named in runs that last some seconds, times the joints."""
        asked = [one for one in hidden if abs(one.torque_N_m) >= LEAST]
        found = [one for one in asked if any(push.overlaps(one) and push.is_like(one) for push in named)]
        return cls(asked, found, [one for one in named if not any(map(one.overlaps, hidden))], joint_s)

    def __str__(self) -> str:
        lines = [f"{'found ' if one in self.found else 'missed'} {one}" for one in self.asked]
        lines += [f"false  {one}" for one in self.false]
        within = f"{len(self.found)} of {len(self.asked)} within {NEAR_S} s and {NEAR_SIZE:.0%}"
        return "\n".join([*lines, f"{within}; {len(self.false)} false in {self.joint_s:.0f} s of a joint\n"])


def hidden_in(path: Path) -> tuple[list[Push], float]:
    """Return the pulses that a run's columns have, and how long it lasts [s]."""
    table = np.genfromtxt(path, delimiter=",", names=True)
    t = table["time"]
    pushes = [
        Push(path.stem, joint, *bump)
        for joint in range(1, N_JOINT + 1)
        for bump in _bumps(t, table[f"tau_pert{joint}"])
    ]
    return pushes, float(t[-1] - t[0])


def _bumps(t: Floats, torque: Floats) -> list[tuple[float, float, float]]:
    """Return each pulse's start and duration at half its height, and its height."""
    edges = np.flatnonzero(np.diff(np.concatenate([[0], np.abs(torque) > _NOTHING, [0]]).astype(int)))
    found = []
    for first, last in zip(edges[::2], edges[1::2], strict=True):
        part = torque[first:last]
        size = float(part[np.argmax(np.abs(part))])
        above = first + np.flatnonzero(np.abs(part) >= abs(size) / 2.0)
        found.append((float(t[above[0]]), float(t[above[-1]] - t[above[0]]), size))
    return found


def named_in(found: Found) -> list[Push]:
    """Return the pushes that a diagnosis names."""
    pushes = [cause for cause in found["causes"] if cause["effect"] == "external_push"]
    numbers = [{name: one["value"] for name, one in cause["parameters"].items()} for cause in pushes]
    return [
        Push(own["trial"], cause["joints"][0], own["start_s"], own["duration_s"], own["torque_N_m"])
        for cause, own in zip(pushes, numbers, strict=True)
    ]


def main() -> None:
    """Diagnose, and compare what is named with what was hidden."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("folder", type=Path)
    parser.add_argument("--runs", default="", help="beginning of the runs' names, as acrobot")
    parser.add_argument("--held-back", type=int, default=2, metavar="N", help="how many of the last are (2)")
    options = parser.parse_args()
    paths = sorted(options.folder.glob(f"{options.runs}*.csv"))
    if not 0 < options.held_back < len(paths):
        parser.error(f"{options.folder}: {len(paths)} runs {options.runs}*.csv, expected more than are held back")
    learn, evaluate = paths[: -options.held_back], paths[-options.held_back :]
    with tempfile.TemporaryDirectory(prefix="limbcal-") as out:
        found = by_command(learn, evaluate, ARM, Path(out), ("--columns", COLUMNS))
    hidden, seconds = zip(*map(hidden_in, paths), strict=True)
    sys.stdout.write(
        str(Score.of([one for some in hidden for one in some], named_in(found), N_JOINT * sum(seconds)))
    )


if __name__ == "__main__":
    main()
