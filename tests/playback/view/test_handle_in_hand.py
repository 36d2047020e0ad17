"""The ball at the tip without a browser: where a drag leads, and what the haptic loop makes of it."""

import asyncio
from collections.abc import Callable, Iterator
from types import SimpleNamespace

import numpy as np
import pytest
import viser
import zmq

from arm.arm_file import load_arm
from arm.kinematics import tip_position
from playback.touch.process import TouchProcess
from playback.view.handle import FREE, HELD, Handle
from playback.view.server import on_loop, web_server
from playback.view.visitors import Visitors
from tests.patience import PATIENCE_S
from tests.playback.view.conftest import eventually

Q0 = np.array([0.4, 0.9])
MakeHandle = Callable[[str], Handle]


@pytest.fixture(scope="module")
def touch() -> Iterator[TouchProcess]:
    with TouchProcess(load_arm("dd-arm"), Q0) as process:
        yield process


@pytest.fixture(scope="module")
def server() -> Iterator[viser.ViserServer]:
    with web_server(Visitors("127.0.0.1"), 0, "limbplay") as server:
        yield server


@pytest.fixture
def handle(
    server: viser.ViserServer, touch: TouchProcess, context: "zmq.Context[zmq.Socket[bytes]]"
) -> Iterator[MakeHandle]:
    """Return what makes the handle of an arm; the arm that is felt is always the same."""
    made: list[Handle] = []

    def make(name: str) -> Handle:
        made.append(on_loop(server, lambda: Handle(server, context, load_arm(name), touch)))
        return made[-1]

    yield make
    for one in made:
        one.close()


def drag(handle: Handle, phase: str, place: list[float], eye: list[float], client: int = 1) -> np.ndarray:
    """Drag the ball as seen from somewhere; return where it is then, with the tip at half a metre."""
    camera = SimpleNamespace(position=tuple(eye))
    event = SimpleNamespace(
        phase=phase, client_id=client, client=SimpleNamespace(camera=camera), end_position=tuple(place)
    )
    asyncio.run(handle._drag(event))
    handle.follow(TIP)
    return np.array(handle._ball.position)


TIP = np.array([0.1, 0.2, 0.5])


def test_free_it_is_the_tip_and_held_it_is_the_hand(handle: MakeHandle) -> None:
    ball = handle("dd-arm")
    ball.follow(TIP)
    assert tuple(ball._ball.position) == tuple(TIP)
    assert tuple(ball._ball.color) == FREE and not ball._spring.visible
    place = drag(ball, "start", [0.3, 0.1, 0.5], [0.0, 0.0, 2.0])
    assert place == pytest.approx([0.3, 0.1, 0.5])
    assert tuple(ball._ball.color) == HELD and ball._spring.visible
    assert np.asarray(ball._spring.points) == pytest.approx(np.array([[TIP, place]]))
    assert drag(ball, "end", [0.3, 0.1, 0.5], [0.0, 0.0, 2.0]) == pytest.approx(TIP)
    assert tuple(ball._ball.color) == FREE and not ball._spring.visible


@pytest.mark.parametrize(
    ("arm", "place", "eye", "target"),
    [
        ("dd-arm", [0.4, 0.0, 1.5], [0.0, 0.0, 2.5], [0.8, 0.0, 0.5]),  # on the plane of the tip
        ("dd-arm", [0.4, 0.0, -0.5], [0.0, 0.0, 2.5], [0.8 / 3.0, 0.0, 0.5]),
        ("dd-arm", [0.0, 0.4, 0.0], [0.0, 0.0, -0.5], [0.0, 0.8, 0.5]),  # from below
        ("dd-arm", [0.4, 0.0, 2.5], [0.0, 0.0, 2.5], [0.4, 0.0, 2.5]),  # a look along the plane meets it nowhere
        ("dd-arm", [0.4, 0.0, 3.0], [0.0, 0.0, 2.5], [0.4, 0.0, 3.0]),  # nor does one away from it
        ("spatial-arm", [0.4, 0.0, 1.5], [0.0, 0.0, 2.5], [0.4, 0.0, 1.5]),  # which moves in no plane
    ],
)
def test_a_drag_leads_to_the_plane_that_the_arm_moves_in(
    handle: MakeHandle, arm: str, place: list[float], eye: list[float], target: list[float]
) -> None:
    ball = handle(arm)
    ball.follow(TIP)
    assert drag(ball, "start", place, eye) == pytest.approx(np.array(target))
    drag(ball, "end", place, eye)


def test_one_hand_at_a_time(handle: MakeHandle) -> None:
    ball, eye = handle("dd-arm"), [0.0, 0.0, 2.0]
    ball.follow(TIP)
    mine, theirs = [0.3, 0.1, 0.5], [-0.3, 0.1, 0.5]
    drag(ball, "start", mine, eye, client=1)
    for phase in ("start", "update", "end"):
        assert drag(ball, phase, theirs, eye, client=2) == pytest.approx(mine)
    assert drag(ball, "update", [0.31, 0.1, 0.5], eye, client=1) == pytest.approx([0.31, 0.1, 0.5])
    drag(ball, "end", mine, eye, client=1)
    assert drag(ball, "update", theirs, eye, client=2) == pytest.approx(TIP)  # what was not taken hold of
    assert drag(ball, "start", theirs, eye, client=2) == pytest.approx(theirs)
    drag(ball, "end", theirs, eye, client=2)


def test_the_haptic_loop_feels_the_hand_and_says_so(handle: MakeHandle, touch: TouchProcess) -> None:
    ball = handle("dd-arm")
    tip = tip_position(load_arm("dd-arm"), Q0[None])[0]
    ball.follow(tip)
    rows = dict(ball.rows())
    assert rows["hand"] == "away" and rows["force"] == "0.00 N"
    assert len(rows) == 5 + 4 and all(value.endswith(" J") for name, value in ball.rows()[5:])
    drag(ball, "start", (tip + [0.0, 0.05, 0.0]).tolist(), [*tip[:2], 2.0])

    def pulled() -> dict[str, str] | None:
        rows = dict(ball.rows())
        return rows if rows["hand"] == "pulls" and float(rows["force"].split()[0]) > 1.0 else None

    rows = eventually(pulled, "the loop feels a pull", PATIENCE_S)
    assert rows["coupling"] == f"{touch.health()['stiffness_N_m']:.0f} N/m"
    asyncio.run(ball._drag(SimpleNamespace(phase="end", client_id=1)))
    eventually(lambda: dict(ball.rows())["hand"] == "away", "the hand lets go", PATIENCE_S)


def test_closed_it_leaves_no_hand(handle: MakeHandle) -> None:
    ball = handle("dd-arm")
    ball.follow(TIP)
    drag(ball, "start", [0.1, 0.2, 0.5], [0.0, 0.0, 2.0])
    ball.close()
    assert not ball._thread.is_alive()


class Loop:
    """Stands for a haptic loop: nobody hears, and health is what the test says."""

    haptic = "tcp://127.0.0.1:1"

    def __init__(self, health: dict[str, object]) -> None:
        self.said = health

    def health(self) -> dict[str, object]:
        return self.said


def test_numbers_of_the_loop_are_told_in_their_units(
    server: viser.ViserServer, context: "zmq.Context[zmq.Socket[bytes]]"
) -> None:
    energy = {"hand": 1.23456, "arm": -0.5, "injected": 0.0, "stored": 2, "dissipated": 3.0, "device": 4.0}
    loop = Loop({
        **{"connected": True, "force_N": 1.234, "stiffness_N_m": 399.6, "held_rate_hz": 999.96},
        **{"lateness_ms": {"p50": 0.1234, "p99": 1.5}, "energy_J": energy},
    })  # fmt: skip
    ball = on_loop(server, lambda: Handle(server, context, load_arm("dd-arm"), loop))  # type: ignore[arg-type]
    try:
        assert ball.rows() == [
            ("hand", "pulls"),
            ("force", "1.23 N"),
            ("coupling", "400 N/m"),
            ("rate held", "1000.0 Hz"),
            ("lateness p50 / p99", "0.123 / 1.500 ms"),
            ("energy, hand", "1.2346 J"),
            ("energy, arm", "-0.5000 J"),
            ("energy, injected", "0.0000 J"),
            ("energy, stored", "2.0000 J"),
        ]
        loop.said = {"lateness_ms": None}
        assert ball.rows() == [
            ("hand", "away"),
            *(("force", "nan N"), ("coupling", "nan N/m"), ("rate held", "nan Hz")),
            ("lateness p50 / p99", "nan / nan ms"),
        ]
    finally:
        ball.close()
