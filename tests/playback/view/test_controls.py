"""What widgets show of a playback's state, and what is wanted of it when somebody moves them."""

import asyncio
from collections.abc import Callable
from types import SimpleNamespace
from typing import Any

import pytest

from playback.view import controls as module
from playback.view.controls import HANDS_OFF_S, Controls

STATE: dict[str, Any] = {
    "playing": False,
    "duration_s": 2.5,
    "speed": 3.0,
    "loop": True,
    "trial": 2,
    "trials": [1, 2, 7],
}


class Widget(SimpleNamespace):
    """A widget, and who hears that it was moved."""

    def on_click(self, callback: Callable[[Any], Any]) -> None:
        self.callback = callback

    on_update = on_click

    def moved(self, value: object, client: int | None = 1) -> None:
        """Move it as a page does; without a client, as this side does."""
        self.value = value
        asyncio.run(self.callback(SimpleNamespace(target=self, client_id=client)))


class Page:
    """Keeps the widgets that are put on it, by their label, and what is wanted."""

    def __init__(self) -> None:
        self.gui = self
        self.widgets: dict[str, Widget] = {}
        self.wanted: list[tuple[str, object]] = []
        self.now_s = 1000.0

    def want(self, cmd: str, value: object = None) -> None:
        self.wanted.append((cmd, value))

    def _add(self, label: str, **known: Any) -> Widget:
        self.widgets[label] = Widget(label=label, disabled=False, visible=True, **known)
        return self.widgets[label]

    def add_button(self, label: str, **looks: Any) -> Widget:
        return self._add(label, **looks)

    def add_slider(self, label: str, least: float, most: float, step: float, value: float, **looks: Any) -> Widget:
        return self._add(label, min=least, max=most, step=step, value=value, **looks)

    def add_button_group(self, label: str, options: tuple[str, ...]) -> Widget:
        return self._add(label, options=options)

    def add_checkbox(self, label: str, value: bool) -> Widget:
        return self._add(label, value=value)

    def add_dropdown(self, label: str, options: tuple[str, ...], initial_value: str) -> Widget:
        return self._add(label, options=options, value=initial_value)


@pytest.fixture
def page(monkeypatch: pytest.MonkeyPatch) -> Page:
    page = Page()
    monkeypatch.setattr(module, "time", SimpleNamespace(monotonic=lambda: page.now_s))
    return page


@pytest.fixture
def controls(page: Page) -> Controls:
    return Controls(page, page)  # type: ignore[arg-type] - server and remote in one


def values(page: Page) -> dict[str, object]:
    return {name: page.widgets[name].value for name in ("Time (s)", "Speed", "Loop", "Trial")}


def test_widgets_show_the_state(page: Page, controls: Controls) -> None:
    controls.show(STATE, 1.23456)
    assert values(page) == {"Time (s)": 1.235, "Speed": 3.0, "Loop": True, "Trial": "2"}
    assert page.widgets["Time (s)"].max == 2.5
    assert page.widgets["Trial"].options == ("1", "2", "7")
    assert not any(widget.disabled for widget in page.widgets.values())
    assert page.wanted == []


def test_the_end_is_not_passed(page: Page, controls: Controls) -> None:
    controls.show(STATE | {"duration_s": 1.0004}, 1.0006)
    assert page.widgets["Time (s)"].value == 1.0004


def test_nothing_can_be_moved_while_nobody_answers(page: Page, controls: Controls) -> None:
    controls.show(None, 0.0)
    steps = page.widgets["Step"]  # which cannot be disabled
    assert all(widget.disabled for widget in page.widgets.values() if widget is not steps)
    assert not steps.visible and not steps.disabled
    controls.show(STATE, 0.0)
    assert not any(widget.disabled for widget in page.widgets.values()) and steps.visible


def test_of_a_live_arm_there_is_play_alone(page: Page, controls: Controls) -> None:
    controls.show(STATE | {"live": True}, 0.5)
    assert [name for name, widget in page.widgets.items() if widget.visible] == ["Play"]
    assert page.widgets["Time (s)"].value == 0.0
    controls.show(STATE, 0.5)
    assert all(widget.visible for widget in page.widgets.values())


def test_one_button_plays_and_pauses(page: Page, controls: Controls) -> None:
    play = page.widgets["Play"]
    controls.show(STATE, 0.0)
    assert play.label == "Play"
    play.moved(None)
    controls.show(STATE | {"playing": True}, 0.0)
    assert play.label == "Pause"
    play.moved(None)
    assert page.wanted == [("play", None), ("pause", None)]


@pytest.mark.parametrize(
    ("label", "moved", "wanted"),
    [
        ("Time (s)", 0.75, ("seek", 0.75)),
        ("Speed", 2, ("speed", 2.0)),
        ("Loop", 0, ("loop", False)),
        ("Trial", "7", ("load", 7)),
    ],
)
def test_what_somebody_moves_is_wanted_and_left_to_him(
    page: Page, controls: Controls, label: str, moved: object, wanted: tuple[str, object]
) -> None:
    controls.show(STATE, 0.0)
    before = values(page)
    page.widgets[label].moved(moved)
    assert page.wanted == [wanted]
    page.now_s += 0.9 * HANDS_OFF_S
    controls.show(STATE, 0.0)
    assert values(page) == before | {label: moved}
    page.now_s += 0.2 * HANDS_OFF_S
    controls.show(STATE, 0.0)
    assert values(page) == before


def test_what_this_side_moves_is_not_wanted(page: Page, controls: Controls) -> None:
    page.widgets["Speed"].moved(4.0, client=None)
    assert page.wanted == []
    controls.show(STATE, 0.0)
    assert page.widgets["Speed"].value == 3.0


@pytest.mark.parametrize(("label", "frames"), [("− 10", -10), ("− 1", -1), ("+ 1", 1), ("+ 10", 10)])
def test_steps_go_by_their_label(page: Page, controls: Controls, label: str, frames: int) -> None:
    assert label in page.widgets["Step"].options
    page.widgets["Step"].moved(label)
    assert page.wanted == [("step", frames)]


def test_before_anything_is_known_widgets_stand_at_their_beginning(page: Page, controls: Controls) -> None:
    time, speed = page.widgets["Time (s)"], page.widgets["Speed"]
    assert (time.min, time.max, time.step, time.value) == (0.0, 1.0, 0.001, 0.0)
    assert (speed.min, speed.max, speed.step, speed.value) == (0.1, 10.0, 0.1, 1.0)
    assert speed.marks == ((0.1, "0.1"), (1.0, "1"), (5.0, "5"), (10.0, "10"))
    assert (page.widgets["Loop"].value, page.widgets["Trial"].value) == (False, "1")
    assert page.widgets["Trial"].options == ("1",)
    controls.show({"playing": False, "duration_s": 2.0}, 0.5)
    assert values(page) == {"Time (s)": 0.5, "Speed": 1.0, "Loop": False, "Trial": "1"}
    page.widgets["Play"].moved(None)
    assert page.wanted == [("play", None)]
