"""A short run of the bench as a daemon streams, records and saves it, what publishes it, and measured data."""

import os
import signal
import threading
import uuid
from collections.abc import Callable, Iterator, Sequence
from contextlib import AbstractContextManager, contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import zmq
from hypothesis import settings
from numpy.typing import NDArray
from zmq.utils.monitor import recv_monitor_message

from arm.arm_file import format_arm, load_arm
from arm.bench import Bench, Sensors, draw_sensor_errors, motions
from arm.counts import COUNT_M_S2
from arm.model import Arm
from arm.simulation import Motion, simulate
from fitter.data.motion_file import write_motion
from fitter.data.motions import Measured
from fitter.live.calibration import Calibration
from fitter.live.stream import MotionAssembler
from protocol.message import FRAMES, HEALTH, TRIAL, encode
from protocol.publisher import Publisher
from protocol.recording import RecordingWriter
from protocol.subscriber import Subscriber
from tests.patience import PATIENCE_S
from tests.soak import Long
from tracking.dead_reckoning.integrator import Integrator

Message = tuple[str, dict[str, Any]]
BLOCK_S, TAIL_S = 0.1, 5.0
START_NS = 7_000_000_000


# Kernels are compiled on first use, and machines are busy: how long an example takes says nothing.
settings.register_profile("patient", deadline=None)
settings.load_profile("patient")

# What a shell starts in the background ignores SIGINT, and so would all that a test starts and interrupts.
if signal.getsignal(signal.SIGINT) is signal.SIG_IGN:
    signal.signal(signal.SIGINT, signal.default_int_handler)


@pytest.fixture(scope="session")
def measured_data() -> Path:
    """Return the folder of real measurements, which are not part of the project."""
    folder = Path(os.environ.get("LIMBCAL_DATA", Path(__file__).parents[1] / ".." / "shared" / "data"))
    if not folder.is_dir():
        pytest.skip(f"no measured data in {folder}; LIMBCAL_DATA can name another folder")
    return folder.resolve()


@pytest.fixture(scope="session", autouse=True)
def one_processor() -> Iterator[None]:
    """Share no work with forked processes unless a test asks for it: other tests have the processors busy.

    To fork a process that has all of the program and of the tests in it takes longer than what is shared then.
    """
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(os, "sched_getaffinity", lambda _process: {0})
        yield


@pytest.fixture
def long(request: pytest.FixtureRequest, record_property: Callable[[str, object], None]) -> Long:
    """Say whether endurance is tested at length."""
    option = request.config.getoption
    return Long(bool(option("--long")), lambda text: record_property("figure", text), float(option("--minutes")))


@dataclass(frozen=True)
class ShortRun:
    """Two learning motions and one to evaluate, at 4 kHz, free of noise but for 16 bits; all on one clock.

    The last target is held for a while, so that the last motion ends too.
    """

    arm: Arm
    bench: Bench
    t: NDArray[np.float64]
    a: NDArray[np.float64]
    truth: dict[str, NDArray[np.float64]]
    trial: NDArray[np.int64]
    messages: tuple[Message, ...]

    def raw_columns(self) -> dict[str, NDArray[Any]]:
        """Return what a file of raw accelerations holds, with truth and target."""
        axes = [f"{sensor.name}{axis}" for sensor in self.arm.sensors for axis in "xyz"]
        readings = {axis: self.a[:, k] for k, axis in enumerate(axes)}
        return {"t": self.t, **readings, "q": self.truth["q"], "ref": self.truth["ref"]}

    def motion_columns(self, trials: Sequence[int], step: int = 8, *without: str) -> dict[str, NDArray[Any]]:
        """Return what a file of joint motion holds: some trials, every `step`-th sample."""
        rows = np.isin(self.trial, trials)
        columns = {name: values[rows][::step] for name, values in self.truth.items() if name not in without}
        return {"t": self.t[rows][::step], **columns, "trial": self.trial[rows][::step]}


@pytest.fixture(scope="session")
def short_run() -> ShortRun:
    return run_of(load_arm("dd-arm"))


def run_of(arm: Arm) -> ShortRun:
    """Return a short run of an arm."""
    bench = Bench(rate_hz=4000.0, learning=2, evaluating=1)
    rng = np.random.default_rng(0)
    sensors = Sensors(arm, draw_sensor_errors(arm, rng, noise=0.0), bench.rate_hz, rng)
    trials = list(motions(arm, bench, seed=0))
    at_end, step = trials[-1], 1.0 / bench.rate_hz
    held = np.tile(at_end.ref[-1], (round(TAIL_S * bench.rate_hz) + 1, 1))
    tail = simulate(arm, held, step, at_end.q[-1], at_end.dq[-1])
    trials.append(Motion(*(getattr(tail, name)[1:] for name in ("t", "q", "dq", "ddq", "tau", "ref"))))
    a = COUNT_M_S2 * np.concatenate([sensors.counts(motion) for motion in trials])
    truth = {
        name: np.concatenate([getattr(motion, name) for motion in trials])
        for name in ("q", "dq", "ddq", "tau", "ref")
    }
    trial = np.repeat([1, 2, 3, 3], [len(motion.t) for motion in trials])
    return ShortRun(
        arm, bench, np.arange(len(a)) / bench.rate_hz, a, truth, trial, tuple(_messages(arm, bench, a))
    )


def _messages(arm: Arm, bench: Bench, a: NDArray[np.float64]) -> Iterator[Message]:
    """Track readings and tell of them as the daemon does."""
    tracker = Integrator(arm, bench.rate_hz, np.zeros(arm.n_joint))
    size = round(BLOCK_S * bench.rate_hz)
    for begin in range(0, len(a), size):
        t0_ns = START_NS + round(begin / bench.rate_hz * 1e9)
        frames, phases = tracker.push(t0_ns, a[begin : begin + size])
        if frames:  # in one message, so that no queue overflows when all are sent in one go
            columns = ("q", "dq", "ddq", "tip", "points")
            joined = {name: np.concatenate([getattr(block, name) for block in frames]) for name in columns}
            yield FRAMES, {**vars(frames[0]), **joined, "n": len(joined["q"]), "method": tracker.method}
        for phase in phases:
            role = "learn" if phase.trial <= bench.learning else "evaluate"
            yield TRIAL, {"trial": phase.trial, "t_ns": phase.t_ns, "state": phase.kind, "role": role}


@pytest.fixture(scope="session")
def measured(short_run: ShortRun) -> tuple[Measured, ...]:
    """Return the motions of the short run, as they are cut out of the stream."""
    assembler = MotionAssembler()
    found = [assembler.feed(*message) for message in short_run.messages]
    return tuple(motion for motion in found if motion is not None)


@pytest.fixture(scope="session")
def calibration(short_run: ShortRun, measured: tuple[Measured, ...]) -> Calibration:
    """Return what is learnt from the short run; to be read only."""
    calibration = Calibration(short_run.arm)
    for motion in measured:
        calibration.add(motion)
    calibration.conclude()
    return calibration


@pytest.fixture(scope="session")
def recording(short_run: ShortRun, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Record the short run as the daemon does; nobody may write to it."""
    path = tmp_path_factory.mktemp("recording") / "day.mcap"
    common = {"arm": short_run.arm.name, "run": str(uuid.uuid4())}
    seq = {FRAMES: 0, TRIAL: 0}
    with RecordingWriter(path, format_arm(short_run.arm), "") as writer:
        for topic, fields in short_run.messages:
            t_ns = fields["t0_ns"] if topic == FRAMES else fields["t_ns"]
            writer.write(topic, encode(topic, {**fields, **common, "seq": seq[topic]})[1], t_ns)
            seq[topic] += 1
    return path


@pytest.fixture(scope="session")
def trial_files(short_run: ShortRun, tmp_path_factory: pytest.TempPathFactory) -> tuple[Path, Path]:
    """Files of joint motion, torque and targets at 500 Hz: two trials to learn from, one to evaluate."""
    folder = tmp_path_factory.mktemp("trials")
    learn, evaluate = folder / "learn.csv", folder / "evaluate.parquet"
    write_motion(learn, short_run.motion_columns([1, 2]))
    write_motion(evaluate, short_run.motion_columns([3]))
    return learn, evaluate


class Stream:
    """Publishes messages from a thread of its own, as soon as somebody has subscribed.

    Attributes
    ----------
    sent : threading.Event
        Everything was published.
    """

    def __init__(self, endpoint: str, messages: Sequence[Message | list[bytes]], arm_name: str) -> None:
        self.endpoint = endpoint
        self.bound = threading.Event()
        self.connected = threading.Event()
        self.sent = threading.Event()
        self._messages = messages
        self._arm_name = arm_name
        self._over = threading.Event()
        self._error: BaseException | None = None
        self._thread = threading.Thread(target=self._serve)
        self._thread.start()
        assert self.bound.wait(PATIENCE_S)

    def close(self) -> None:
        """End the thread; raise what went wrong in it."""
        self._over.set()
        self._thread.join(PATIENCE_S)
        if self._error is not None:
            raise self._error

    def _serve(self) -> None:
        try:
            with zmq.Context() as context, Publisher(context, self.endpoint, self._arm_name, "run 1") as publisher:
                self.endpoint = publisher.endpoint
                monitor = publisher._socket.get_monitor_socket(zmq.EVENT_HANDSHAKE_SUCCEEDED)
                self.bound.set()
                try:
                    if self._subscribed(context, publisher, monitor):
                        self._publish(publisher)
                finally:
                    publisher._socket.disable_monitor()
                    monitor.close(0)
        except BaseException as error:  # noqa: BLE001 - raised again where it is seen
            self._error = error
        finally:
            self.bound.set()

    def _subscribed(self, context: Any, publisher: Publisher, monitor: Any) -> bool:
        """Wait for a subscriber, and then for one after it: by then the first one's topics are known."""
        while not monitor.poll(20):
            if self._over.is_set():
                return False
        recv_monitor_message(monitor)
        self.connected.set()
        with Subscriber(context, publisher.endpoint, ["probe"]) as probe:
            while probe.receive(20) is None:
                publisher.publish("probe", {})
                if self._over.is_set():
                    return False
        return True

    def _publish(self, publisher: Publisher) -> None:
        for message in self._messages:
            if isinstance(message, tuple):
                publisher.publish(*message)
            else:
                publisher._socket.send_multipart(message)
        self.sent.set()
        while not self._over.wait(0.1):
            publisher.publish(HEALTH, {"last_seq": dict(publisher.last_seq)})


@pytest.fixture
def stream(short_run: ShortRun) -> Callable[..., AbstractContextManager[Stream]]:
    """Return what publishes messages, by default all of the short run: ``with stream(endpoint) as s: …``."""

    @contextmanager
    def publishing(
        endpoint: str, messages: Sequence[Message | list[bytes]] | None = None, arm_name: str = "dd-arm"
    ) -> Iterator[Stream]:
        one = Stream(endpoint, short_run.messages if messages is None else messages, arm_name)
        try:
            yield one
        finally:
            one.close()

    return publishing
