"""A ball at the tip: dragged in a page, it pulls the simulated arm along; let go, it is back at the tip."""

import math
import threading
import time
from typing import Any

import numpy as np
import viser
import zmq

from arm.kinematics import axis_frames
from arm.model import Arm
from limbcal.errors import ProtocolError
from playback.shape import reach_m, rgb
from playback.touch.device import TouchDevice
from playback.touch.process import TouchProcess
from playback.trajectory import Floats

#: A page says some twenty times a second where the ball is, and the haptic loop forgets a hand after 20 ms: the
#: hand in between goes there smoothly, and says so every few milliseconds.
PERIOD_S, SMOOTH_S = 0.004, 0.03
FREE, HELD = rgb("d64045"), rgb("f09628")
#: Sine or cosine of an angle below which two directions count as parallel, or a line as lying in a plane [1].
PARALLEL = 1e-6


class Handle:
    """The ball, the spring that is drawn from it to the tip, and the hand that it is to the haptic loop.

    Parameters
    ----------
    server : viser.ViserServer
    context : zmq.Context
    arm : Arm
    touch : TouchProcess
        The simulated arm, running.
    """

    def __init__(
        self,
        server: viser.ViserServer,
        context: "zmq.Context[zmq.Socket[bytes]]",
        arm: Arm,
        touch: TouchProcess,
    ) -> None:
        self._arm, self._touch, self._context = arm, touch, context
        self._normal = _normal(arm)
        self._ball = server.scene.add_icosphere(
            "/handle", radius=0.055 * reach_m(arm), color=FREE, opacity=0.75, subdivisions=3, cast_shadow=False
        )
        self._spring = server.scene.add_line_segments(
            "/spring", np.zeros((1, 2, 3)), HELD, thickness=4.0, thickness_units="screen", visible=False
        )
        self._tip = np.zeros(3)
        self._client: int | None = None  # whose page drags
        self._target: Floats = np.zeros(3)
        self._held, self._over = threading.Event(), False
        self._ball.on_drag("left")(self._drag)
        self._thread = threading.Thread(target=self._be_hand, name="hand")
        self._thread.start()

    def follow(self, tip: Floats) -> None:
        """Be where the tip is, (3,) [m], or where the hand is that pulls it."""
        self._tip = tip
        held = self._held.is_set()
        place = self._target if held else tip
        self._ball.position = place
        self._ball.color = HELD if held else FREE
        self._spring.visible = held
        if held:
            self._spring.points = np.array([[tip, place]], dtype=np.float32)

    def rows(self) -> list[tuple[str, str]]:
        """Return what is known of the haptic loop, as names and values.

        Raises
        ------
        DeviceError
            If it has ended by itself.
        """
        health = self._touch.health()
        late, energy = health.get("lateness_ms") or {}, health.get("energy_J") or {}
        rows = [
            ("hand", "pulls" if health.get("connected") else "away"),
            ("force", f"{_number(health.get('force_N')):.2f} N"),
            ("coupling", f"{_number(health.get('stiffness_N_m')):.0f} N/m"),
            ("rate held", f"{_number(health.get('held_rate_hz')):.1f} Hz"),
            ("lateness p50 / p99", f"{_number(late.get('p50')):.3f} / {_number(late.get('p99')):.3f} ms"),
        ]
        return rows + [(f"energy, {name}", f"{_number(value):.4f} J") for name, value in energy.items()][:4]

    def close(self) -> None:
        """Let go, and end the thread."""
        self._over = True
        self._held.set()
        self._thread.join()

    async def _drag(self, event: Any) -> None:
        if event.phase == "start" and not self._held.is_set():
            self._client = event.client_id
        if event.client_id != self._client:
            return  # one hand at a time
        if event.phase == "end":
            self._held.clear()
            self._client = None
            return
        self._target = self._on_plane(np.array(event.client.camera.position), np.array(event.end_position))
        self._held.set()

    def _on_plane(self, eye: Floats, place: Floats) -> Floats:
        """Return where a look through ``place`` meets the plane that the arm moves in, if it moves in one."""
        if self._normal is None:
            return place
        look = place - eye
        slope = float(look @ self._normal)
        if abs(slope) < PARALLEL:
            return place
        along = float((self._tip - eye) @ self._normal) / slope
        return eye + along * look if along > 0.0 else place

    def _be_hand(self) -> None:
        with TouchDevice(self._context, self._touch.haptic) as device:
            while True:
                self._held.wait()
                if self._over:
                    return
                self._pull(device)

    def _pull(self, device: TouchDevice) -> None:
        """Go where the ball is dragged until it is let go."""
        place, last_s = self._tip.copy(), time.monotonic()
        while self._held.is_set() and not self._over:
            now_s = time.monotonic()
            share = 1.0 - math.exp(-(now_s - last_s) / SMOOTH_S)
            velocity = (self._target - place) / SMOOTH_S
            place, last_s = place + share * (self._target - place), now_s
            device.send(place, velocity)
            try:
                device.latest()  # what is felt is seen: a page has no motor
            except ProtocolError:
                return
            time.sleep(PERIOD_S)


def _normal(arm: Arm) -> Floats | None:
    """Return the direction that all joints turn about, (3,), None where they differ: the arm is not planar."""
    axes = axis_frames(arm, np.zeros((1, arm.n_joint)))[0, :, :3, 2]
    revolute = all(joint.type == "revolute" for joint in arm.joints)
    if revolute and np.abs(np.cross(axes, axes[0])).max() < PARALLEL:
        normal: Floats = axes[0]
        return normal
    return None


def _number(value: object) -> float:
    return float(value) if isinstance(value, int | float) else math.nan
