"""Arms with sensors, their bench recordings, and what a tracker makes of them."""

from collections.abc import Callable, Iterable
from dataclasses import dataclass, replace
from functools import cache

import numpy as np
import pytest

from arm.accelerometer import specific_force
from arm.arm_file import load_arm
from arm.bench import Bench, Sensors, draw_sensor_errors, motions, rest_angles
from arm.counts import COUNT_M_S2
from arm.model import Arm, Control, Floats, Friction, Joint, Link, Sensor, Tip
from tracking.dead_reckoning.integrator import Integrator
from tracking.kalman.kalman_filter import KalmanTracker
from tracking.model.frames import Frames, Phase
from tracking.model.readings import Readings, ReadingsBuilder

RUBBING = Friction(0.2, 0.05, 0.05)


def rod(mass_kg: float) -> Link:
    return Link(mass_kg, (0.1, 0.02, 0.0), (0.02, 0.1, 0.1, 0.0, 0.0, 0.0))


#: A joint that turns carries one that slides; one sensor is enough for the latter. All sit askew.
SLIDING = Arm(
    "turn-and-slide",
    (
        Joint(a_m=0.2, link=rod(3.0), friction=RUBBING),
        Joint("prismatic", alpha_rad=np.pi / 2, d_m=0.3, link=rod(2.0), friction=RUBBING),
    ),
    sensors=(
        Sensor("s1", 1, (0.05, 0.0, 0.0)),
        Sensor("s2", 1, (0.15, 0.05, 0.0), (0.2, -0.4, 0.6)),
        Sensor("s3", 2, (0.02, 0.01, 0.1), (0.3, 0.2, 0.1)),
    ),
    tip=Tip("s3"),
    control=Control("pd", (20.0, 40.0), (-8.0, -16.0)),
)
#: Three joints whose axes point every way, so gravity shows differently in every pose.
SPATIAL = Arm(
    "spatial",
    (
        Joint(d_m=0.2, link=rod(3.0), friction=RUBBING),
        Joint(alpha_rad=np.pi / 2, a_m=0.3, theta_offset_rad=0.3, link=rod(2.0), friction=RUBBING),
        Joint(alpha_rad=-0.4, a_m=0.25, d_m=0.02, beta_rad=0.2, link=rod(1.0), friction=RUBBING),
    ),
    sensors=tuple(
        Sensor(
            f"s{k}",
            (k + 1) // 2,
            (0.05 + 0.15 * (k % 2), 0.03 * (k % 3), 0.02 * k),
            (0.1 * k, -0.2 * k, 0.3),
        )
        for k in range(1, 7)
    ),
    tip=Tip("s6"),
    control=Control("pd", (30.0, 30.0, 15.0), (-14.0, -14.0, -6.0)),
)


#: Two branches on the first link, one at its far end and one beside it: a tree.
BRANCHING = replace(
    SPATIAL,
    name="branching",
    joints=(
        *SPATIAL.joints[:2],
        replace(SPATIAL.joints[2], parent=1, parent_position_m=(0.1, 0.2, 0.05), alpha_rad=1.1),
    ),
)


@dataclass(frozen=True)
class Recording:
    """Readings (n, 3 * n_sensor), what moved there, and when."""

    arm: Arm
    rate_hz: float
    readings: Floats
    t: Floats
    q: Floats
    dq: Floats
    ddq: Floats

    @property
    def dt_ns(self) -> float:
        return 1e9 / self.rate_hz


def record(
    arm: Arm, bench: Bench, seed: int, noise: float = 0.0, exact: bool = False, imperfect: bool = False
) -> Recording:
    """Return the bench's trials one after the other; ``exact`` readings are not even rounded to counts."""
    rng = np.random.default_rng([seed, 7])
    sensors = Sensors(arm, draw_sensor_errors(arm, rng, noise, imperfect), bench.rate_hz, rng)
    trials = list(motions(arm, bench, seed))
    if exact:
        readings = [specific_force(arm, m.q, m.dq, m.ddq).reshape(len(m.t), -1) for m in trials]
    else:
        readings = [sensors.counts(m) * COUNT_M_S2 for m in trials]
    q, dq, ddq = (np.vstack([getattr(m, name) for m in trials]) for name in ("q", "dq", "ddq"))
    return Recording(arm, bench.rate_hz, np.vstack(readings), np.arange(len(q)) / bench.rate_hz, q, dq, ddq)


def glide(arm: Arm, rate_hz: float, travel: Iterable[float], seconds: float = 1.5) -> Recording:
    """Return exact readings of half a second's rest and one motion as smooth as a polynomial of ninth degree."""
    t = np.arange(round((seconds + 0.5) * rate_hz)) / rate_hz
    s = np.clip((t - 0.5) / seconds, 0.0, 1.0)[:, None]
    far = np.asarray(list(travel))
    q = far * s**5 * (126 - 420 * s + 540 * s**2 - 315 * s**3 + 70 * s**4)
    dq = far * 630 * (s * (1 - s)) ** 4 / seconds
    ddq = far * 2520 * (s * (1 - s)) ** 3 * (1 - 2 * s) / seconds**2
    return Recording(arm, rate_hz, specific_force(arm, q, dq, ddq).reshape(len(t), -1), t, q, dq, ddq)


class Tracked:
    """Frames as whole arrays, beside the truth at their own time stamps."""

    def __init__(self, recording: Recording, frames: Iterable[Frames], phases: Iterable[Phase]) -> None:
        self.frames, self.phases = list(frames), list(phases)
        for name in ("q", "dq", "ddq", "tip", "points"):
            setattr(self, name, np.concatenate([getattr(f, name) for f in self.frames]))
        self.t_ns = np.concatenate([f.t0_ns + np.round(np.arange(f.n) * f.dt_s * 1e9) for f in self.frames])
        self.number = np.concatenate([f.frame0 + np.arange(f.n) for f in self.frames])
        claims = [f.q_std for f in self.frames if f.q_std is not None]
        self.q_std = np.concatenate(claims) if claims else None
        self._recording = recording

    def truth(self, name: str = "q", shift_s: float = 0.0) -> Floats:
        recording = self._recording
        columns = getattr(recording, name).T
        return np.column_stack([np.interp(self.t_ns * 1e-9 + shift_s, recording.t, column) for column in columns])

    def error_deg(self, name: str = "q") -> Floats:
        return np.rad2deg(np.abs(getattr(self, name) - self.truth(name)))

    def bytes(self) -> list[bytes]:
        """Return everything as bytes, for comparison to the last bit."""
        names = ("q", "dq", "ddq", "tip", "points", "t_ns", "number")
        return [getattr(self, name).tobytes() for name in names] + [repr(self.phases).encode()]


def track(recording: Recording, arm: Arm | None = None, **options: object) -> Tracked:
    """Return what the tracker makes of a recording, pushed in one piece."""
    tracker = Integrator(arm or recording.arm, recording.rate_hz, recording.q[0], **options)
    frames, phases = tracker.push(0, recording.readings)
    rest = tracker.flush()
    return Tracked(recording, [*frames, *rest[0]], [*phases, *rest[1]])


def follow(
    recording: Recording, q0: Floats | None, arm: Arm | None = None, rate_hz: float = 1000.0, block: int = 512
) -> tuple[Tracked, KalmanTracker]:
    """Return what the filter makes of a recording, and the filter itself."""
    tracker = KalmanTracker(arm or recording.arm, recording.rate_hz, q0, rate_hz)
    frames, phases = [], []
    for first in range(0, len(recording.readings), block):
        t0_ns = round(first * recording.dt_ns)
        more, ended = tracker.push(t0_ns, recording.readings[first : first + block])
        frames, phases = frames + more, phases + ended
    more, ended = tracker.flush()
    return Tracked(recording, frames + more, phases + ended), tracker


def decimate(recording: Recording, rate_hz: float = 1000.0, lost: slice | None = None) -> Readings:
    """Return a recording's readings at the rate of the frames, without those that were lost."""
    builder = ReadingsBuilder(recording.rate_hz, recording.readings.shape[1], rate_hz)
    builder.push(recording.readings[: lost.start if lost else None])
    if lost:
        builder.gap(lost.stop - lost.start)
        builder.push(recording.readings[lost.stop :])
    return builder.done()


@pytest.fixture(scope="session")
def vertical_arm() -> Arm:
    return load_arm("dd-arm-vertical")


@pytest.fixture(scope="session")
def level_bench(dd_arm: Arm) -> Recording:
    """Return three standard trials of the level arm at 4 kHz."""
    return record(dd_arm, Bench(4000.0, learning=3, evaluating=0), 0, 1.0)


@pytest.fixture(scope="session")
def upright_bench(vertical_arm: Arm) -> Recording:
    """Return two short trials of the upright arm at 4 kHz."""
    return record(vertical_arm, Bench(4000.0, trial_s=4.0, learning=2, evaluating=0), 1, 1.0)


@pytest.fixture(scope="session")
def followed() -> Callable[..., tuple[Tracked, KalmanTracker]]:
    """Return what follows a recording with the filter: `follow`."""
    return follow


@pytest.fixture(scope="session")
def decimated() -> Callable[..., Readings]:
    """Return what decimates a recording: `decimate`."""
    return decimate


@pytest.fixture(scope="session")
def dd_arm() -> Arm:
    return load_arm("dd-arm")


@pytest.fixture(scope="session")
def sliding() -> Arm:
    return SLIDING


@pytest.fixture(scope="session")
def branching() -> Arm:
    return BRANCHING


@pytest.fixture(scope="session")
def spatial() -> Arm:
    return SPATIAL


@pytest.fixture(scope="session")
def recorded() -> Callable[..., Recording]:
    """Return what makes bench recordings: `record`."""
    return record


@pytest.fixture(scope="session")
def glided() -> Callable[..., Recording]:
    """Return what makes one smooth motion: `glide`."""
    return glide


@pytest.fixture(scope="session")
def tracked() -> Callable[..., Tracked]:
    """Return what tracks a recording: `track`."""
    return track


@pytest.fixture(scope="session")
def gather() -> type[Tracked]:
    """Return what puts frames beside the truth: `Tracked`."""
    return Tracked


@pytest.fixture(scope="session")
def standard_bench() -> Callable[[str, int, float], tuple[Recording, Tracked]]:
    """Return the standard bench's first five trials and the rest after them, tracked; each is run once."""

    @cache
    def run(name: str, seed: int, noise: float) -> tuple[Recording, Tracked]:
        arm = load_arm(name)
        whole = record(arm, Bench(learning=5, evaluating=1), seed, noise)
        until = round((5 * 6.75 + 0.5) * whole.rate_hz)
        recording = Recording(
            arm,
            whole.rate_hz,
            *(getattr(whole, field)[:until] for field in ("readings", "t", "q", "dq", "ddq")),
        )
        np.testing.assert_array_equal(recording.q[0], rest_angles(arm, np.zeros(arm.n_joint)))
        return recording, track(recording)

    return run
