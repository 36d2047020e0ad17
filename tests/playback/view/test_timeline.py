"""What the plots under the time line are given to draw: degrees, millimetres, and where the present is."""

from collections.abc import Sequence
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from arm.arm_file import load_arm
from arm.model import Arm, Joint
from playback.view.feed import Pose, Row
from playback.view.remote import Motion
from playback.view.timeline import LIVE_SPAN_S, Timeline

ARM = load_arm("dd-arm")
T = np.linspace(0.0, 4.0, 41)
Q = np.column_stack([0.5 + 0.1 * T, -1.0 + 0.2 * T])
TIP = np.column_stack([T, 0.0 * T, 0.0 * T])
OFF = np.column_stack([0.02 * T, -0.01 * T])


class Page:
    """Keeps the plots that are put on it."""

    def __init__(self) -> None:
        self.plots: list[Any] = []
        self.gui = self

    def add_uplot(self, **plot: Any) -> Any:
        found = SimpleNamespace(**plot)
        found.remove = lambda: self.plots.remove(found)
        self.plots.append(found)
        return found


def drawn(plot: Any) -> tuple[np.ndarray, list[np.ndarray], np.ndarray]:
    """Return a plot's time, its lines, and the line at the present."""
    t, *lines, upright = plot.data
    return t, lines, upright


def motion(twin: bool) -> Motion:
    fields: dict[str, Any] = {"t": T, "q": Q, "tip": TIP}
    if twin:
        fields |= {"twin_q": Q + OFF, "twin_tip": TIP + [0.0, 0.003, 0.004]}
    return Motion(fields)


def shown(twin: bool, position_s: float, motion: Motion | None, rows: Sequence[Row] = ()) -> list[Any]:
    page = Page()
    line = Timeline(page, ARM, twin)  # type: ignore[arg-type] - of a server it asks for plots alone
    line.take(motion)
    line.draw(position_s, rows)
    return page.plots


def test_one_arm_has_its_joints_in_degrees_and_no_second_plot() -> None:
    (angles,) = shown(False, 1.0, motion(False))
    t, lines, _ = drawn(angles)
    assert [one["label"] for one in angles.series] == ["t (s)", "q1", "q2", "now"]
    assert len(lines) == 2
    for j, line in enumerate(lines):
        assert line == pytest.approx(np.interp(t, T, np.degrees(Q[:, j])))


def test_a_twin_is_drawn_beside_and_what_is_between_the_two() -> None:
    angles, errors = shown(True, 1.0, motion(True))
    t, lines, _ = drawn(angles)
    assert [one["label"] for one in angles.series] == ["t (s)", "q1", "q2", "q1 twin", "q2 twin", "now"]
    for j in range(2):
        assert lines[2 + j] == pytest.approx(np.interp(t, T, np.degrees((Q + OFF)[:, j])))
    t, (joints, tip), _ = drawn(errors)
    assert joints == pytest.approx(np.degrees(0.02) * t)  # the joint that is farther off
    assert tip == pytest.approx(5.0)  # 3 and 4 mm


def test_a_twin_that_says_nothing_is_a_line_at_zero() -> None:
    angles, errors = shown(True, 1.0, motion(False))
    assert np.abs(drawn(angles)[1][2:]).max() == 0.0
    assert np.abs(drawn(errors)[1]).max() == 0.0


@pytest.mark.parametrize(("position_s", "at_s"), [(1.03, 1.03), (0.0, 0.0), (4.0, 4.0), (-1.0, 0.0), (9.0, 4.0)])
def test_the_present_is_upright_over_the_whole_range(position_s: float, at_s: float) -> None:
    (angles,) = shown(False, position_s, motion(False))
    t, _, upright = drawn(angles)
    bottom, top = angles.scales["y"]["range"]
    assert np.all(np.diff(t) >= 0.0)
    assert set(upright) == {bottom, top}
    (k,) = np.flatnonzero(upright == top)
    assert t[k - 1] == t[k] == t[k + 1] == at_s


def test_ranges_hold_what_is_drawn_and_little_more() -> None:
    angles, errors = shown(True, 1.0, motion(True))
    for plot in (angles, errors):
        _, lines, _ = drawn(plot)
        low, high = np.min(lines), np.max(lines)
        bottom, top = plot.scales["y"]["range"]
        assert bottom <= low < high < top
        assert top - bottom < 2.0 * (high - min(low, bottom + 0.5 * (high - low)))
        assert plot.scales["x"]["range"] == (0.0, 4.0)
    assert errors.scales["y"]["range"][0] == 0.0
    (high_up,) = shown(False, 1.0, Motion({"t": T, "q": Q + 50.0, "tip": TIP}))
    assert high_up.scales["y"]["range"][0] > np.degrees(48.0)  # zero need not be seen


def test_a_stream_is_drawn_back_from_the_present() -> None:
    rows = [Row(float(t), Pose(q, tip), Pose(q + off, tip)) for t, q, tip, off in zip(T, Q, TIP, OFF, strict=True)]
    (angles, errors) = shown(True, 4.0, None, rows)
    t, lines, upright = drawn(angles)
    assert t[upright == angles.scales["y"]["range"][1]].tolist() == [0.0]
    assert angles.scales["x"]["range"] == errors.scales["x"]["range"] == (-LIVE_SPAN_S, 0.0)
    assert (t[0], t[-1]) == (-4.0, 0.0)
    assert lines[0] == pytest.approx(np.interp(t + 4.0, T, np.degrees(Q[:, 0])))
    assert drawn(errors)[1][0] == pytest.approx(np.degrees(0.02) * (t + 4.0))


def test_a_single_frame_is_no_line() -> None:
    page = Page()
    line = Timeline(page, ARM, False)  # type: ignore[arg-type]
    before = page.plots[0].data
    line.draw(0.0, [Row(0.0, Pose(Q[0], TIP[0]), None)])
    assert page.plots[0].data is before
    line.draw(0.1, [Row(0.1 * k, Pose(Q[k], TIP[k]), None) for k in range(2)])
    assert page.plots[0].data is not before


def test_plots_are_taken_off_the_page() -> None:
    page = Page()
    line = Timeline(page, ARM, True)  # type: ignore[arg-type]
    assert len(page.plots) == 2
    line.remove()
    assert page.plots == []


def level(degrees: Sequence[float], twin_degrees: Sequence[float] = ()) -> list[Row]:
    """Return rows a second apart whose joints are all at these angles, and their twin's at those."""
    rows = []
    for k, angle in enumerate(degrees):
        pose = Pose(np.radians([angle, angle]), np.zeros(3))
        other = Pose(np.radians([twin_degrees[k]] * 2), np.zeros(3)) if k < len(twin_degrees) else None
        rows.append(Row(float(k), pose, other))
    return rows


def test_a_range_that_lines_hardly_fill_is_drawn_anew_far_from_zero() -> None:
    page = Page()
    line = Timeline(page, ARM, False)  # type: ignore[arg-type]
    ranges = []
    for k, degrees in enumerate(([100.0, 110.0], [101.0, 108.0], [104.0, 105.0])):
        line.draw(1.0 + k, level(degrees))
        ranges.append(page.plots[0].scales["y"]["range"])
    assert ranges[1] == ranges[0]  # seven of twenty degrees fill it
    bottom, top = ranges[2]
    assert bottom <= 104.0 and 105.0 <= top and top - bottom < 5.0


def test_before_anything_is_heard_every_line_is_at_zero() -> None:
    for plot in shown(True, 0.0, None):
        t, *lines = plot.data
        assert t.tolist() == [0.0, 1.0]
        assert [line.tolist() for line in lines] == [[0.0, 0.0]] * (len(plot.series) - 1)
        assert plot.scales["x"]["range"] == plot.scales["y"]["range"] == (0.0, 1.0)


def test_a_joint_that_slides_is_drawn_in_millimetres() -> None:
    page, arm = Page(), Arm("slide", (Joint(a_m=0.1), Joint("prismatic", a_m=0.1)))
    line = Timeline(page, arm, False)  # type: ignore[arg-type]
    line.take(motion(False))
    line.draw(0.0, [])
    assert page.plots[0].title == "joints (° or mm)"
    _, (turned, slid), _ = drawn(page.plots[0])
    assert (turned[-1], slid[-1]) == pytest.approx((np.degrees(0.9), -200.0))


@pytest.mark.parametrize(("n_row", "points"), [(2, 2), (220, 220), (1000, 220)])
def test_a_long_motion_is_thinned_out(n_row: int, points: int) -> None:
    t = np.linspace(1.0, 3.0, n_row)
    (angles,) = shown(False, 1.0, Motion({"t": t, "q": np.column_stack([t, t]), "tip": np.zeros((n_row, 3))}))
    at, lines, _ = drawn(angles)
    assert len(at) == points + 3  # those of the line at the present
    assert (at[0], at[-1]) == (1.0, 3.0)
    assert lines[0] == pytest.approx(np.degrees(at))


def test_a_motion_of_one_instant_is_none() -> None:
    one = Motion({"t": T[:1], "q": Q[:1], "tip": TIP[:1]})
    (angles,) = shown(False, 0.0, one, level([10.0, 20.0]))
    assert angles.scales["x"]["range"] == (-LIVE_SPAN_S, 0.0) == (-10.0, 0.0)


@pytest.mark.parametrize("missing", ["twin_q", "twin_tip"])
def test_half_a_twin_is_none(missing: str) -> None:
    fields = {"t": T, "q": Q, "tip": TIP, "twin_q": Q + OFF, "twin_tip": TIP + 1.0}
    angles, errors = shown(True, 1.0, Motion({k: v for k, v in fields.items() if k != missing}))
    assert np.abs(drawn(angles)[1][2:]).max() == np.abs(drawn(errors)[1]).max() == 0.0


def test_a_twin_that_is_heard_only_at_times_is_a_line_at_zero() -> None:
    angles, errors = shown(True, 2.0, None, level([10.0, 20.0, 30.0], [11.0, 22.0]))
    assert np.abs(drawn(angles)[1][2:]).max() == np.abs(drawn(errors)[1]).max() == 0.0
    angles, errors = shown(True, 2.0, None, level([10.0, 20.0, 30.0], [11.0, 22.0, 34.0]))
    assert drawn(errors)[1][0][-1] == pytest.approx(4.0)


def test_only_what_has_changed_is_drawn_anew() -> None:
    page = Page()
    line = Timeline(page, ARM, False)  # type: ignore[arg-type]
    line.draw(1.0, level([0.0, 100.0]))
    first = page.plots[0].data
    line.draw(1.0, level([0.0, 100.0]))
    assert page.plots[0].data is first
    line.draw(1.0, level([0.0, 50.0, 100.0]))
    assert page.plots[0].data is not first
    first = page.plots[0].data
    line.draw(1.5, level([0.0, 50.0, 100.0]))
    assert page.plots[0].data is not first
    line.take(motion(False))
    line.draw(1.5, [])
    first = page.plots[0].data
    line.take(motion(False))
    line.draw(1.5, [])
    assert page.plots[0].data is not first


def test_a_line_that_stays_level_has_a_narrow_range() -> None:
    (angles,) = shown(False, 1.0, None, level([30.0, 30.0]))
    bottom, top = angles.scales["y"]["range"]
    assert bottom < 30.0 < top and top - bottom < 3e-6
