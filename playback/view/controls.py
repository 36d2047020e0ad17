"""The widgets that tell a playback what to do."""

import time
from collections.abc import Mapping
from typing import Any

import viser

from playback.control_message import Value
from playback.playhead import MAX_SPEED, MIN_SPEED
from playback.view.remote import Remote

#: How long a widget that was touched is left to whoever touched it [s].
HANDS_OFF_S = 0.8
STEPS = {"− 10": -10, "− 1": -1, "+ 1": 1, "+ 10": 10}
#: What of the state can be set in a widget, and takes effect a little later.
SPEED_STEP, TIME_STEP_S = 0.1, 0.001


class Controls:
    """Play, pause, stop, step, seek, speed, loop and the list of trials.

    Widgets show the playback's state, so that all pages agree; who moves one is not disturbed by it meanwhile.

    Parameters
    ----------
    server : viser.ViserServer
        In whose present folder the widgets are put.
    remote : Remote
    """

    def __init__(self, server: viser.ViserServer, remote: Remote) -> None:
        gui = server.gui
        self._remote = remote
        self._touched: dict[str, float] = {}
        self._playing = False
        self._play = gui.add_button("Play", icon=viser.Icon.PLAYER_PLAY, color="blue")
        self.time = gui.add_slider("Time (s)", 0.0, 1.0, TIME_STEP_S, 0.0)
        self._step = gui.add_button_group("Step", tuple(STEPS))
        self._speed = gui.add_slider(
            "Speed",
            MIN_SPEED,
            MAX_SPEED,
            SPEED_STEP,
            1.0,
            marks=((0.1, "0.1"), (1.0, "1"), (5.0, "5"), (10.0, "10")),
        )
        self._loop = gui.add_checkbox("Loop", False)
        self._trial = gui.add_dropdown("Trial", ("1",), initial_value="1")

        @self._play.on_click
        async def _(_event: object) -> None:
            self._remote.want("pause" if self._playing else "play")

        @self._step.on_click
        async def _(event: viser.GuiEvent[Any]) -> None:
            self._remote.want("step", STEPS[event.target.value])

        @self.time.on_update
        async def _(event: viser.GuiEvent[Any]) -> None:
            self._hear("time", event, "seek", float(event.target.value))

        @self._speed.on_update
        async def _(event: viser.GuiEvent[Any]) -> None:
            self._hear("speed", event, "speed", float(event.target.value))

        @self._loop.on_update
        async def _(event: viser.GuiEvent[Any]) -> None:
            self._hear("loop", event, "loop", bool(event.target.value))

        @self._trial.on_update
        async def _(event: viser.GuiEvent[Any]) -> None:
            self._hear("trial", event, "load", int(event.target.value))

    def show(self, state: Mapping[str, Any] | None, position_s: float) -> None:
        """Show the playback's state, and the place of the frame that is shown."""
        here = state is not None
        for widget in (self._play, self.time, self._speed, self._loop, self._trial):
            widget.disabled = not here
        self._step.visible = here  # a group of buttons cannot be disabled
        if state is None:
            return
        self._playing = bool(state["playing"])
        self._play.label = "Pause" if self._playing else "Play"
        self._play.icon = viser.Icon.PLAYER_PAUSE if self._playing else viser.Icon.PLAYER_PLAY
        stored = not state.get("live")
        for part in (self.time, self._step, self._speed, self._loop, self._trial):
            part.visible = stored
        if not stored:
            return
        duration_s = round(float(state["duration_s"]), 6)
        if self.time.max != duration_s:
            self.time.max = duration_s
        if self._free("time"):
            _set(self.time, min(round(position_s, 3), duration_s))
        if self._free("speed"):
            _set(self._speed, float(state.get("speed", 1.0)))
        if self._free("loop"):
            _set(self._loop, bool(state.get("loop", False)))
        trials = tuple(map(str, state.get("trials", ())))
        if trials and trials != tuple(self._trial.options):
            self._trial.options = trials
        if trials and self._free("trial"):
            _set(self._trial, str(state["trial"]))

    def _hear(self, name: str, event: viser.GuiEvent[Any], cmd: str, value: Value) -> None:
        if event.client_id is not None:  # else it was this side that moved the widget
            self._touched[name] = time.monotonic()
            self._remote.want(cmd, value)

    def _free(self, name: str) -> bool:
        return time.monotonic() - self._touched.get(name, -HANDS_OFF_S) >= HANDS_OFF_S


def _set(widget: Any, value: float | bool | str) -> None:
    widget.value = value  # of any widget: checkers do not see the setter that stands apart from its getter
