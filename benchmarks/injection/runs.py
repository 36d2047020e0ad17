"""The recordings in which effects are hidden, and how the arm moved in them."""

import os
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cache
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from benchmarks.hidden_arms.unexplained import lowpass
from limbcal.errors import DataError

Floats = NDArray[np.float64]

ROOT = Path(__file__).parents[2]
DATA = Path(os.environ.get("LIMBCAL_DATA", ROOT.parent / "shared" / "data"))
ARM = ROOT / "examples" / "dfki-pendulum.toml"

#: Runs to learn from and to evaluate on. Those of `dfki_perturbed` are driven by the torque that was measured,
#: pulses included, so in them too nothing is hidden before something is injected; `tau_pert` is not used.
SETS = {
    "double": (
        "dfki_double_pendulum",
        tuple(f"20230629-{clock}" for clock in ("143339", "143524", "143601", "143704", "143906", "144003")),
        ("20230629-154220",),
    ),
    "perturbed": (
        "dfki_perturbed",
        tuple(f"{robot}-{number:02}" for robot in ("acrobot", "pendubot") for number in (1, 2, 3)),
        ("acrobot-04", "pendubot-04"),
    ),
}
#: The runs of a set are on one clock, this many seconds apart: what warms up goes on from one run to the next.
PAUSE_S = 5.0
#: Rate at which angles are differentiated, near that of the recordings, and their corner frequency [Hz].
RATE_HZ, ANGLE_HZ = 500.0, 20.0
#: A joint is at rest below this speed [rad/s]: three standard deviations of what the encoder's step of 3.8e-4 rad,
#: 1.1e-4 rad rms, makes of speed below `ANGLE_HZ`.
REST_RAD_S = 0.05


@dataclass(frozen=True)
class Run:
    """One recording.

    Attributes
    ----------
    name : str
    number : int
        Which of its set's runs it is, from 1, learning runs first.
    learning : bool
    t : (n_sample,) [s]
        On the set's clock.
    q, tau : (n_sample, n) [rad], [N m]
        As recorded.
    motion : (n_sample, n) each
        Smoothed angle, velocity, acceleration, and the direction of motion: at rest that of the last motion.
    """

    name: str
    number: int
    learning: bool
    t: Floats
    q: Floats
    tau: Floats
    motion: tuple[Floats, Floats, Floats, Floats]

    @property
    def moving(self) -> NDArray[np.bool_]:
        """Where joints move (n_sample, n)."""
        return np.abs(self.motion[1]) > REST_RAD_S

    def write(self, folder: Path, tau: Floats) -> Path:
        """Write the run with another torque, and return the file's path."""
        path = folder / f"{self.name}.npz"
        columns = {
            f"{name}{i + 1}": x[:, i] for name, x in (("q", self.q), ("tau", tau)) for i in range(x.shape[1])
        }
        np.savez(path, t=self.t, **columns)
        return path


@cache
def read_set(name: str) -> tuple[Run, ...]:
    """Read the runs of a set, learning ones first.

    Raises
    ------
    DataError
        If a recording is absent.
    """
    folder, learn, evaluate = SETS[name]
    runs: list[Run] = []
    begin = 0.0
    for number, run in enumerate((*learn, *evaluate), 1):
        path = DATA / folder / f"{run}.csv"
        if not path.is_file():
            raise DataError(f"{path}: there is no such file; set LIMBCAL_DATA to the folder of the recordings")
        t, q, tau = _columns(path, ("time",), ("pos_meas1", "pos_meas2"), ("tau_meas1", "tau_meas2"))
        clock = t[:, 0] - t[0, 0] + begin
        begin = float(clock[-1]) + PAUSE_S
        runs.append(Run(run, number, run in learn, clock, q, tau, motion_of(clock, q)))
    return tuple(runs)


def _columns(path: Path, *names: Sequence[str]) -> list[Floats]:
    with path.open(encoding="utf-8") as file:
        header = file.readline().strip().split(",")
    table = np.loadtxt(path, delimiter=",", skiprows=1)
    return [table[:, [header.index(name) for name in some]] for some in names]


def motion_of(t: Floats, q: Floats) -> tuple[Floats, Floats, Floats, Floats]:
    """Return smoothed angle, velocity, acceleration and direction of motion at irregular samples."""
    grid = np.arange(t[0], t[-1], 1.0 / RATE_HZ)
    angle = lowpass(np.stack([np.interp(grid, t, column) for column in q.T], axis=1), RATE_HZ, ANGLE_HZ)
    speed = np.gradient(angle, 1.0 / RATE_HZ, axis=0)
    gain = np.gradient(speed, 1.0 / RATE_HZ, axis=0)
    smooth, dq, ddq = (
        np.stack([np.interp(t, grid, column) for column in x.T], axis=1) for x in (angle, speed, gain)
    )
    return smooth, dq, ddq, np.stack([_direction(column) for column in dq.T], axis=1)


def _direction(dq: Floats) -> Floats:
    """Return 1 or -1; at rest what it was before, and before the first motion what it is then."""
    moving = np.flatnonzero(np.abs(dq) > REST_RAD_S)
    if not len(moving):
        return np.ones(len(dq))
    last = np.clip(np.searchsorted(moving, np.arange(len(dq)), side="right") - 1, 0, None)
    return np.sign(dq[moving[last]])


def rms(columns: Sequence[Floats]) -> float:
    """Return the root mean square over all runs."""
    return float(np.sqrt(np.mean(np.concatenate(columns) ** 2)))
