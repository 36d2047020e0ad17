"""How the hand behind the ball goes to where the ball is dragged, and which plane a drag keeps to."""

import asyncio
import threading
from collections.abc import Iterator
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
import viser

from arm.model import Arm, Joint
from limbcal.errors import ProtocolError
from playback.view import handle as module
from playback.view.handle import Handle, _normal
from playback.view.server import on_loop, web_server
from playback.view.visitors import Visitors
from tests.patience import PATIENCE_S

FLAT = Arm("flat", (Joint(a_m=0.3), Joint(a_m=0.2)))
TIP, GOAL = np.array([0.5, 0.0, 0.0]), np.array([0.2, 0.4, 0.0])


class Device:
    """Stands for the hand's line to the haptic loop; refuses after so many inputs."""

    def __init__(self, refuses_after: int) -> None:
        self.sent: list[tuple[list[float], list[float]]] = []
        self.refuses_after = refuses_after

    def __call__(self, _context: object, _endpoint: str) -> "Device":
        return self

    def __enter__(self) -> "Device":
        return self

    def __exit__(self, *_: object) -> None:
        pass

    def send(self, place: np.ndarray, velocity: np.ndarray) -> None:
        self.sent.append((place.tolist(), velocity.tolist()))

    def latest(self) -> None:
        if len(self.sent) == self.refuses_after:
            raise ProtocolError("refused")


@pytest.fixture
def server() -> Iterator[viser.ViserServer]:
    with web_server(Visitors("127.0.0.1"), 0, "limbplay") as server:
        yield server


@pytest.mark.parametrize("refuses_after", [0, 3])
def test_the_hand_goes_smoothly_to_the_ball_every_four_milliseconds(
    server: viser.ViserServer, monkeypatch: pytest.MonkeyPatch, refuses_after: int
) -> None:
    device, over = Device(refuses_after), threading.Event()
    now_s, slept = [100.0], list[float]()

    def sleep(seconds: float) -> None:
        slept.append(seconds)
        now_s[0] += seconds
        if len(slept) == 5:
            ball._held.clear()  # let go
            over.set()

    monkeypatch.setattr(module, "TouchDevice", device)
    monkeypatch.setattr(module, "time", SimpleNamespace(monotonic=lambda: now_s[0], sleep=sleep))
    touch: Any = SimpleNamespace(haptic="tcp://nobody")
    ball = on_loop(server, lambda: Handle(server, None, FLAT, touch))  # type: ignore[arg-type] - nobody needs it
    try:
        ball.follow(TIP)
        client = SimpleNamespace(camera=SimpleNamespace(position=(0.0, 0.0, 2.0)))
        event = SimpleNamespace(phase="start", client_id=1, client=client, end_position=tuple(GOAL))
        asyncio.run(ball._drag(event))
        assert over.wait(PATIENCE_S)
    finally:
        ball.close()
    times = [0.004 * k for k in range(5)]
    if refuses_after:  # it takes hold once more, from the tip
        times = [*times[:3], *times[:3]]
    assert slept == [0.004] * 5
    places = [GOAL + (TIP - GOAL) * np.exp(-t / 0.03) for t in times]
    np.testing.assert_allclose([place for place, _ in device.sent], places, atol=1e-12)
    before = [TIP if t == 0.0 else GOAL + (TIP - GOAL) * np.exp(-(t - 0.004) / 0.03) for t in times]
    np.testing.assert_allclose([v for _, v in device.sent], [(GOAL - place) / 0.03 for place in before], atol=1e-9)


@pytest.mark.parametrize(("tilt_rad", "planar"), [(0.0, True), (0.1, False), (np.pi, True)])
def test_axes_that_are_parallel_make_a_plane(tilt_rad: float, planar: bool) -> None:
    normal = _normal(Arm("two", (Joint(a_m=0.3), Joint(alpha_rad=tilt_rad, a_m=0.2))))
    assert (normal is not None) is planar
    assert normal is None or normal == pytest.approx([0.0, 0.0, 1.0])
    assert _normal(Arm("two", (Joint(a_m=0.3), Joint("prismatic")))) is None
