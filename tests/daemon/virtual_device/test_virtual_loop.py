"""What the virtual device sends and says, on a clock that passes beat by beat, with neither process nor port."""

import json
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

import daemon.virtual_device.virtual_loop as module
from arm.arm_file import load_arm
from daemon.virtual_device.bench_plan import BenchPlan
from daemon.virtual_device.virtual_device import Timing, device_info
from daemon.virtual_device.virtual_loop import VirtualOptions, serve
from limbcal.errors import DeviceError
from protocol.serial_frame import InfoFrame, SamplesFrame, encode_info
from protocol.serial_parser import FrameParser

RATE_HZ = 1000.0
FRAME_BYTES = 32 * 12 * 2 + 28


class World:
    """A clock, a port, a host and a stop that comes after some beats."""

    def __init__(self) -> None:
        self.now_s = 100.0
        self.beats = 0
        self.until = 200
        self.periods: list[float] = []
        self.waited: list[float] = []
        self.there_after = 1
        self.takes = 10**9  # bytes that the host's end holds
        self.came = b""
        self.said: list[bytes] = [b"START\n"]
        self.port_log: list[str] = []
        self.capacities: list[int] = []
        self.done: dict[str, int] = {}
        self.at_beat: dict[int, Any] = {}
        self.lags: list[float] = []

    def frames(self) -> list[InfoFrame | SamplesFrame]:
        return FrameParser().feed(self.came)


class Port:
    def __init__(self, world: World) -> None:
        self._world, self.path, self.plugged = world, "/dev/pts/77", True

    def plug(self) -> None:
        self.plugged = True
        self._world.port_log.append("plug")

    def unplug(self) -> None:
        self.plugged = False
        self._world.port_log.append("unplug")

    def read(self) -> bytes:
        return self._world.said.pop(0)

    def write(self, data: bytes) -> int:
        taken = data[: self._world.takes]
        self._world.takes -= len(taken)
        self._world.came += taken
        return len(taken)

    def __enter__(self) -> "Port":
        return self

    def __exit__(self, *_: object) -> None:
        self._world.port_log.append("closed")


class Source:
    """Samples that are all there, and count themselves."""

    def __init__(self, world: World, keep_truth: bool) -> None:
        self._world, self._keep = world, keep_truth
        self.taken = 0

    def wait(self, timeout_s: float) -> bool:
        self._world.waited.append(timeout_s)
        return len(self._world.waited) >= self._world.there_after

    def fetch(self) -> None:
        return

    def take(self, n: int) -> np.ndarray:
        self.taken += n
        return np.full((n, 12), self.taken // n, dtype=np.int16)

    def truth(self) -> dict[str, np.ndarray]:
        return {"t": np.arange(self.taken) / RATE_HZ} if self._keep else {}

    def close(self) -> None:
        self._world.port_log.append("source closed")


@pytest.fixture
def world(monkeypatch: pytest.MonkeyPatch) -> World:
    made = World()
    port = Port(made)
    stop = SimpleNamespace(came=False)

    class Stop:
        def __enter__(self) -> SimpleNamespace:
            return stop

        def __exit__(self, *_: object) -> None:
            return

    class Beat:
        def __init__(self, period_s: float, _clock: object, sleep: Any) -> None:
            made.periods.append(period_s)
            self._period_s, self._sleep = period_s, sleep

        def wait(self) -> None:
            self._sleep(self._period_s)
            made.now_s += self._period_s
            made.beats += 1
            stop.came = made.beats >= made.until

        def skip_missed(self) -> None:
            return

    class FaultInjection:
        def __init__(self, _faults: object, _info: object, _device: object, line: Any, _port: object) -> None:
            self._line = line

        def make(self, now_s: float) -> None:
            made.lags.append(made.now_s - now_s)
            self._line.done.update(made.done)
            made.done = {}
            if made.beats in made.at_beat:
                made.at_beat[made.beats](port)

    def select(
        readable: Sequence[object], writable: Sequence[object], _: object, _s: float
    ) -> tuple[Any, Any, Any]:
        assert (port in readable) == port.plugged
        return ([port] if made.said and port.plugged else []), [one for one in writable if made.takes], []

    fifo = module.FrameFifo

    def new_fifo(capacity: int) -> object:
        made.capacities.append(capacity)
        return fifo(capacity)

    names = {
        "VirtualPort": lambda _link: port,
        "StopSignal": Stop,
        "Ticker": Beat,
        "FaultInjection": FaultInjection,
        "MotionSource": lambda _plan, keep: Source(made, keep),
        "FrameFifo": new_fifo,
        "select": select,
        "ask_for_real_time": lambda _: False,
        "time": SimpleNamespace(monotonic=lambda: made.now_s),
    }
    for name, value in names.items():
        monkeypatch.setattr(module, name, value)
    return made


def options(**more: Any) -> VirtualOptions:
    plan = BenchPlan(load_arm("dd-arm"), seed=3, rate_hz=RATE_HZ, trials=2, noise=0.5, highpass_hz=0.2)
    plain = VirtualOptions(plan, RATE_HZ, Timing(RATE_HZ), 1.0, None, None, as_json=False)
    return replace(plain, **more)


def test_frames_come_as_they_are_due(world: World, capsys: pytest.CaptureFixture[str]) -> None:
    serve(options())
    info, *samples = world.frames()
    assert isinstance(info, InfoFrame) and info.info.rate_hz == RATE_HZ
    # START was heard before the first beat had passed: 200 beats of 5 ms are a second
    assert len(samples) == int(1.0 * RATE_HZ) // 32
    assert [int(frame.counts[0, 0]) for frame in samples] == list(range(1, len(samples) + 1))
    assert world.periods == [0.005] and set(world.lags) == {0.0}
    said = capsys.readouterr()
    assert said.out == "/dev/pts/77\n" and said.err == ""
    # while it is not ready there is no port; at the end all is closed
    assert world.port_log == ["unplug", "plug", "source closed", "closed"]


def test_frames_that_the_host_does_not_read_are_counted(world: World, capsys: pytest.CaptureFixture[str]) -> None:
    world.takes, world.until = 0, 1000
    serve(options())
    # INFO and the frames of five seconds have come; the memory holds half a second and 64 KiB
    info = encode_info(device_info(load_arm("dd-arm"), RATE_HZ, 3), 0, 0)
    dropped = int(5.0 * RATE_HZ) // 32 - (world.capacities[0] - len(info)) // FRAME_BYTES
    assert capsys.readouterr().err.splitlines() == [
        "the host does not read: frames are dropped",
        f"frames dropped, as the host did not read: {dropped}",
    ]
    assert world.came == b""


def test_a_device_that_was_kept_from_running_drops_nothing_while_its_host_reads(
    world: World, capsys: pytest.CaptureFixture[str]
) -> None:
    held = 64 * FRAME_BYTES  # of the tty, emptied once a beat

    def pause(_port: object) -> None:
        world.now_s += 4.0

    def read(_port: object) -> None:
        world.takes = held

    world.takes, world.until = held, 401
    world.at_beat = {beat: read for beat in range(1, 401)}
    world.at_beat[99] = pause
    serve(options(speed=2.0))
    assert max(world.lags) > 3.0 and world.lags[-1] == 0.0
    assert capsys.readouterr().err == ""
    numbers = [int(frame.counts[0, 0]) for frame in world.frames()[1:]]
    assert numbers == list(range(1, int(6.005 * 2.0 * RATE_HZ) // 32 + 1))


def test_frames_that_waited_are_sent_when_the_host_reads_again(
    world: World, capsys: pytest.CaptureFixture[str]
) -> None:
    world.takes, world.until = 0, 400
    world.at_beat = {399: lambda _: setattr(world, "takes", 10**9)}
    serve(options())
    assert len(world.frames()) - 1 == int(2.0 * RATE_HZ) // 32
    assert capsys.readouterr().err == ""


def test_a_patient_arm_waits_for_its_host(world: World, capsys: pytest.CaptureFixture[str]) -> None:
    world.takes, world.until = 0, 1000
    serve(options(patient=True))
    assert capsys.readouterr().err == ""


def test_without_a_plug_nothing_is_kept(world: World) -> None:
    world.at_beat = {50: lambda port: port.unplug(), 150: lambda port: port.plug()}
    serve(options())
    numbers = [int(frame.counts[0, 0]) for frame in world.frames()[1:]]
    assert numbers == [*range(1, 8), *range(24, 32)]  # 0.25 s and 0.75 s after START


@pytest.mark.parametrize("said", [True, False])
def test_what_faults_have_hit_is_said_at_the_end(
    world: World, capsys: pytest.CaptureFixture[str], said: bool
) -> None:
    world.done = {"drop": 3, "flip": 1} if said else {}
    serve(options())
    assert capsys.readouterr().err == ("frames hit by faults: 3 by drop, 1 by flip\n" if said else "")


def test_the_announcement_says_all_that_was_asked_for(
    world: World, capsys: pytest.CaptureFixture[str], tmp_path: Path
) -> None:
    world.until = 1
    link = tmp_path / "link"
    serve(options(claimed_hz=999.0, timing=Timing(RATE_HZ, clock=1.0002), speed=2.0, link=link, as_json=True))
    announced = json.loads(capsys.readouterr().out)
    assert announced.pop("clock_ppm") == pytest.approx(200.0)
    assert announced == {
        "port": "/dev/pts/77",
        "link": str(link),
        "arm": "dd-arm",
        "seed": 3,
        "rate_hz": 999.0,
        "sampled_hz": RATE_HZ,
        "speed": 2.0,
        "trials": 2,
        "noise": 0.5,
        "highpass_hz": 0.2,
    }
    world.said = [b"START\n"]
    serve(options(as_json=True))
    assert json.loads(capsys.readouterr().out)["link"] is None


def test_the_truth_of_what_was_sent_is_written(world: World, tmp_path: Path) -> None:
    path = tmp_path / "truth"
    serve(options(truth=path))
    with np.load(path) as written:
        assert len(written["t"]) == 31 * 32
    world.beats, world.said = 0, [b"START\n"]
    with pytest.raises(DeviceError, match=r"^--truth .* cannot be written: Is a directory$"):
        serve(options(truth=tmp_path))
