"""The page: what is shown of a playback, and the loop that keeps it up to date."""

import time
from collections.abc import Callable, Mapping
from functools import partial
from typing import Any

import numpy as np
import viser

from arm.model import Arm
from playback.measured_markers import MeasuredMarkers
from playback.shape import REAL, TWIN
from playback.trajectory import Floats
from playback.view.controls import Controls
from playback.view.feed import Feed, Picture
from playback.view.figure import Figure
from playback.view.handle import Handle
from playback.view.marker_errors import MarkerErrors
from playback.view.remote import Motion, Remote
from playback.view.server import on_loop
from playback.view.sheet import heading, numbers, table
from playback.view.stage import Stage
from playback.view.timeline import LIVE_SPAN_S, Timeline
from playback.view.trace import SPAN_S, Trace

#: Pictures a second at the most [Hz]: what screens show.
RATE_HZ = 60.0
#: Once in this many pictures the panel is brought up to date: 10 Hz.
PANEL_EVERY = 6
#: Time without a frame after which a source is silent [s].
SILENT_S = 2.0
BESIDE, ON_TOP, ALONE = "beside the arm", "on top of it", "hidden"
TWIN_OPACITY = 0.45


class Page:
    """Shows the newest frame of a feed at up to 60 Hz, to every browser alike.

    It is made, and changed, in the server's thread: see `on_loop`.

    Parameters
    ----------
    server : viser.ViserServer
    feed : Feed
    remote : Remote or None
        None where there is nothing to control, as with a live stream.
    arm : Arm
    twin : Arm or None
    handle : Handle, optional
        Where the arm can be touched.
    markers : mapping of int to MeasuredMarkers, optional
        By trial, where the motion was tracked from markers.
    """

    def __init__(
        self,
        server: viser.ViserServer,
        feed: Feed,
        remote: Remote | None,
        arm: Arm,
        twin: Arm | None,
        handle: Handle | None = None,
        markers: Mapping[int, MeasuredMarkers] | None = None,
    ) -> None:
        self._server, self._feed, self._remote = server, feed, remote
        self._arm, self._twin = arm, twin
        self.pictures = 0
        self._shown: Picture | None = None
        self._motion: Motion | None = None
        gui = server.gui
        gui.configure_theme(
            control_width="large", show_logo=False, show_share_button=False, brand_color=(47, 93, 140)
        )
        gui.main_panel.dock_right()
        gui.main_panel.set_width(390.0)
        self._head = gui.add_html("")
        self._controls = None if remote is None else Controls(server, remote)
        self._timeline = Timeline(server, arm, twin is not None)
        self._numbers = gui.add_html("")
        self._handle, self._touch = handle, None
        if handle is not None:
            with gui.add_folder("Touch"):
                gui.add_markdown("Drag the red ball: the tip is pulled by a spring.")
                self._touch = gui.add_html("")
        self._stage = Stage(server, arm, _tips(remote))
        self._stage.look(two=twin is not None)
        self._figures = [Figure(server, "/arm", arm, REAL)]
        self._traces = [Trace(server, "/arm trace", REAL.trace)]
        if twin is not None:
            self._figures.append(Figure(server, "/twin", twin, TWIN, TWIN_OPACITY))
            self._traces.append(Trace(server, "/twin trace", TWIN.trace))
        self._markers = None if markers is None else MarkerErrors(server, arm, markers)
        self._add_choices()
        self._arrange()

    def run(self, over: Callable[[], bool]) -> None:
        """Keep the page up to date until it is over."""
        start_s, k = time.monotonic(), 0
        while not over():
            on_loop(self._server, partial(self.refresh, k % PANEL_EVERY == 0))
            k += 1
            wait_s = start_s + k / RATE_HZ - time.monotonic()
            if wait_s < -1.0 / RATE_HZ:  # pictures that are late are left out, not made up for
                k = int((time.monotonic() - start_s) * RATE_HZ) + 1
                wait_s = start_s + k / RATE_HZ - time.monotonic()
            time.sleep(max(0.0, wait_s))

    def refresh(self, panel: bool) -> None:
        """Bring the scene, and if asked for the panel, up to date; for the server's thread."""
        picture = self._feed.newest()
        if picture is not None and (self._shown is None or picture.count != self._shown.count):
            self._shown = picture
            self.pictures += 1
            with self._server.atomic():
                self._move(picture)
            self._server.flush()
        if panel:
            with self._server.atomic():
                self._tell()

    def _move(self, picture: Picture) -> None:
        row = picture.row
        poses = [row.real] if row.twin is None else [row.real, row.twin]
        for figure, pose in zip(self._figures, poses, strict=False):
            if len(pose.q) == figure.arm.n_joint:
                figure.show(pose.q)
        if self._handle is not None:
            self._handle.follow(row.real.tip)
        if self._markers is not None and len(row.real.q) == self._arm.n_joint:
            self._markers.show(picture.fields.get("trial"), row.position_s, row.real.q)
        past = self._feed.history(SPAN_S)
        for trace, name in zip(self._traces, ("real", "twin"), strict=False):
            known = [
                (then.position_s, pose.tip) for then in [*past, row] if (pose := getattr(then, name)) is not None
            ]
            trace.show([at for at, _ in known], [tip for _, tip in known])

    def _tell(self) -> None:
        picture, state = self._shown, None if self._remote is None else self._remote.state
        self._head.content = heading(self._arm, self._twin, *self._status(picture, state))
        position_s = 0.0 if picture is None else picture.row.position_s
        if self._controls is not None and self._remote is not None:
            if picture is None and state is not None and not state["playing"] and not state["live"]:
                self._remote.want("seek", state["position_s"])  # what stands still is sent when it is asked for
            self._controls.show(state, position_s)
            if self._remote.motion is not self._motion:
                self._motion = self._remote.motion
                self._timeline.take(self._motion)
        self._timeline.draw(position_s, [] if self._motion is not None else self._feed.history(LIVE_SPAN_S))
        if picture is not None:
            rows = numbers(self._arm, picture, state)
            self._numbers.content = table(rows if self._markers is None else [*self._markers.rows(), *rows])
        if self._touch is not None and self._handle is not None:
            self._touch.content = table(self._handle.rows())

    def _status(self, picture: Picture | None, state: Mapping[str, Any] | None) -> tuple[str, str, str]:
        """Return what is played, in one word how, and the colour of that word."""
        heard = picture is not None and time.monotonic() - picture.heard_s < SILENT_S
        source = "" if picture is None else picture.source
        if self._remote is None:
            return source or self._feed.endpoint, *(("live", "#2f9e5b") if heard else ("silent", "#a0a7b0"))
        if state is None:
            return source or self._remote.endpoint, "no answer", "#b04a5a"
        if state.get("live"):
            return str(state["source"]), *(("live", "#2f9e5b") if heard else ("silent", "#a0a7b0"))
        return str(state["source"]), *(("playing", "#2f5d8c") if state["playing"] else ("paused", "#8a94a0"))

    def _add_choices(self) -> None:
        with self._server.gui.add_folder("Show"):
            gui = self._server.gui
            self._place = (
                gui.add_dropdown("Twin", (BESIDE, ON_TOP, ALONE), initial_value=BESIDE)
                if self._twin is not None
                else None
            )
            self._measured = None if self._markers is None else gui.add_checkbox("Measured markers", True)
            self._sensors = gui.add_checkbox("Sensors", True)
            self._labels = gui.add_checkbox("Sensor names", True)
            self._axes = gui.add_checkbox("Joint frames", True)
            self._paths = gui.add_checkbox("Tip traces", True)
            self._shadows = gui.add_checkbox("Shadows", False, hint="needs a graphics processor")
        parts = (self._measured, self._sensors, self._labels, self._axes, self._paths)
        for widget in (self._place, *parts, self._shadows):
            if widget is not None:
                widget.on_update(self._on_choice)

    async def _on_choice(self, _event: object) -> None:
        self._arrange()

    def _arrange(self) -> None:
        """Put the arms where they are wanted, with what is wanted of them."""
        self._stage.shade(self._shadows.value)
        if self._markers is not None and self._measured is not None:
            self._markers.seen(self._measured.value)
        place = ALONE if self._place is None else self._place.value
        beside: Floats = self._stage.beside if place == BESIDE else np.zeros(3)
        for index, (figure, trace) in enumerate(zip(self._figures, self._traces, strict=True)):
            here = index == 0 or place != ALONE
            named = self._labels.value and (index == 0 or place == BESIDE)
            figure.seen(here, self._sensors.value, named, self._axes.value)
            figure.stand_at(index * beside)
            trace.stand_at(index * beside)
            trace.wanted = here and self._paths.value


def _tips(remote: Remote | None) -> Floats | None:
    """Return where the tips get to in the trial that is loaded, (k, 3) [m], where that is known."""
    motion = None if remote is None else remote.motion
    if motion is None:
        return None
    return motion.tip if motion.twin_tip is None else np.concatenate([motion.tip, motion.twin_tip])
