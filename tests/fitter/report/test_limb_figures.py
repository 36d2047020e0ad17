"""Pictures of a limb: where its joints, markers and ellipses are drawn, and when markers were away."""

from dataclasses import replace

import numpy as np
import pytest
from matplotlib.colors import to_hex
from matplotlib.patches import Ellipse

from arm.kinematics import axis_frames
from benchmarks.simulated_people.person import person
from fitter.limb.limb_calibration import calibrate
from fitter.limb.limb_fit import LimbFit
from fitter.limb.marker_observations import SWAY
from fitter.limb.written_arm import calibrated_arm
from fitter.report.figures import ERROR, MEASURED, SIMULATED
from fitter.report.limb_figures import angles_over_time, gaps_and_swaps, marker_errors, stick_figure
from limbcal.note import Note
from protocol.markers.recording import MarkerRecording


@pytest.fixture(scope="module")
def fit() -> LimbFit:
    truth = person(n=100, trials=2)
    return calibrate(list(truth.recordings), truth.marker_set, "human-arm-right", fit_frames=60)


@pytest.fixture
def recording() -> MarkerRecording:
    """Two seconds at 50 Hz; the first marker is away from 0.4 to 0.8 s."""
    plain = person(n=100).recordings[0]
    positions = plain.positions.copy()
    positions[20:40, 0] = np.nan
    return replace(plain, positions=positions)


def test_the_limb_is_drawn_in_three_planes_of_its_base(fit: LimbFit) -> None:
    figure = stick_figure(fit)
    k = len(fit.task.frames.t) // 2
    joints = axis_frames(calibrated_arm(fit, None), fit.bundle.q[[k], SWAY:])[0, :, :3, 3]
    planes = (("sagittal", 0, 2, "forward [m]", "up [m]"), ("frontal", 1, 2, "left [m]", "up [m]"))
    planes += (("transverse", 0, 1, "forward [m]", "left [m]"),)
    for axes, (name, across, upward, x, y) in zip(figure.axes, planes, strict=True):
        assert (axes.get_title(), axes.get_xlabel(), axes.get_ylabel()) == (f"{name} plane", x, y)
        chain, seen, modelled, *ways = axes.lines
        drawn = np.column_stack(chain.get_data())[: len(joints)]
        np.testing.assert_allclose(np.diff(drawn, axis=0), np.diff(joints, axis=0)[:, [across, upward]], atol=1e-9)
        apart = np.column_stack(seen.get_data()) - np.column_stack(modelled.get_data())
        assert 1e-6 < np.nanmax(np.abs(apart)) < 0.02
        for line in ways:
            assert np.linalg.norm(np.diff(np.column_stack(line.get_data()), axis=0)) <= 0.12 + 1e-9
    spans = [
        [np.diff(np.column_stack(line.get_data()), axis=0)[0] for line in axes.lines[3:]] for axes in figure.axes
    ]
    sagittal, frontal, _ = map(np.array, spans)
    np.testing.assert_allclose(sagittal[:, 0] ** 2 + frontal[:, 0] ** 2 + frontal[:, 1] ** 2, 0.12**2)


def test_centres_have_ellipses_that_hold_them_with_95_percent(fit: LimbFit) -> None:
    """Their squared half-axes are what chi squared with two degrees of freedom has, times the variances."""
    figure = stick_figure(fit)
    names = list(fit.where.centres)
    areas = []
    for axes in figure.axes:
        ellipses = [patch for patch in axes.patches if isinstance(patch, Ellipse)]
        assert [text.get_text() for text in axes.texts] == names and len(ellipses) == len(names)
        for ellipse, text in zip(ellipses, axes.texts, strict=True):
            assert ellipse.center == pytest.approx(text.xy)
        areas.append([ellipse.width**2 + ellipse.height**2 for ellipse in ellipses])
    at, covariance = len(fit.errors.apart[0].lengths), fit.errors.derived_covariance
    for k in range(len(names)):
        variance = np.trace(covariance[at + 3 * k :, at + 3 * k :][:3, :3])
        # each axis is in two of the three planes; 5.991 is the 95 % quantile
        assert sum(one[k] for one in areas) == pytest.approx(4.0 * 5.9915 * 2.0 * variance, rel=1e-4)


def test_an_ellipse_without_a_covariance_is_left_out(fit: LimbFit) -> None:
    unknown = np.full_like(fit.errors.derived_covariance, np.nan)
    figure = stick_figure(replace(fit, errors=replace(fit.errors, derived_covariance=unknown)))
    assert not [patch for axes in figure.axes for patch in axes.patches]


def test_angles_are_drawn_in_degrees_trial_after_trial(fit: LimbFit) -> None:
    rows = angles_over_time(fit).axes
    assert [row.get_ylabel() for row in rows] == [f"q{k + 1} [°]" for k in range(7)]
    trials = fit.task.frames.trial
    assert len(np.unique(trials)) == 2
    for k, row in enumerate(rows):
        first, second = row.lines
        for line, trial in zip(row.lines, np.unique(trials), strict=True):
            degrees = 180.0 / np.pi * fit.bundle.q[trials == trial, SWAY + k]
            np.testing.assert_allclose(line.get_ydata(), degrees)
            np.testing.assert_allclose(np.diff(line.get_xdata()), np.diff(fit.task.frames.t[trials == trial]))
        assert first.get_xdata()[0] == 0.0
        assert second.get_xdata()[0] == pytest.approx(first.get_xdata()[-1] + 0.5)


def test_markers_on_bony_points_come_first_and_the_worst_on_top() -> None:
    (axes,) = marker_errors([("a", 1.0), ("b", 3.0), ("c", 2.0), ("d", 4.0)], {"a", "c"}).axes
    assert [text.get_text() for text in axes.get_yticklabels()] == ["c", "a", "d", "b"]
    assert [bar.get_width() for bar in axes.patches] == [2.0, 1.0, 4.0, 3.0]
    assert [to_hex(bar.get_facecolor()) for bar in axes.patches] == [SIMULATED] * 2 + [MEASURED] * 2
    low, high = axes.get_ylim()
    assert low > high


def bars(axes: object, colour: str) -> list[tuple[float, float, float]]:
    """Return begin, end and row of the bars of a colour."""
    found = [one for one in axes.collections if len(one.get_paths()) and to_hex(one.get_facecolor()[0]) == colour]
    boxes = [path.get_extents() for one in found for path in one.get_paths()]
    return [(box.x0, box.x1, round(0.5 * (box.y0 + box.y1), 6)) for box in boxes]


def test_a_gap_is_grey_and_what_was_never_there_grey_throughout(recording: MarkerRecording) -> None:
    (axes,) = gaps_and_swaps([recording, recording], [*recording.names[:2], "nobody"], []).axes
    expected = [(0.4, 0.8, 0.0), (0.0, 2.0, 2.0), (2.4, 2.8, 0.0), (2.0, 4.0, 2.0)]
    np.testing.assert_allclose(bars(axes, "#999999"), expected)
    assert axes.get_xlim() == (0.0, 4.0) and axes.get_ylim() == (2.5, -0.5)


@pytest.mark.parametrize(
    ("since", "until", "begin", "end"), [(0.2, 0.6, 2.2, 2.6), (None, 0.6, 2.0, 2.6), (0.2, None, 2.2, 4.0)]
)
def test_an_exchange_is_red_in_its_own_recording(recording, since, until, begin, end) -> None:
    other = replace(recording, path="folder/other.trc")
    names = recording.names[:3]
    swap = Note("swapped", "", source="other.trc", columns=(*names[1:], "x"), from_s=since, to_s=until)
    gap = Note("gap", "", source="other.trc", columns=names, from_s=0.0, to_s=1.0)
    (axes,) = gaps_and_swaps([recording, other], names, [swap, gap, replace(swap, source=None)]).axes
    np.testing.assert_allclose(sorted(bars(axes, ERROR)), [(begin, end, 1.0), (begin, end, 2.0)])
