"""Pictures of a diagnosis: which trials are drawn, and where their lines run."""

from types import SimpleNamespace

import numpy as np
import pytest
from matplotlib.colors import to_hex
from matplotlib.figure import Figure
from scipy.signal import periodogram

from fitter.report import diagnosis_figures
from fitter.report.diagnosis_figures import (
    AFTER,
    BEFORE,
    angles_figure,
    gains_figure,
    places_figure,
    remainder_figure,
    residual_figure,
)
from fitter.report.diagnosis_traces import Trace
from fitter.report.figures import MEASURED

#: So many that what is left when stuck samples are gone parts evenly into bins.
N, DT, SEEN_HZ = 490, 0.01, 20.0


def trace(number: int, size: float, learn: bool = False, angle: float = 0.1) -> Trace:
    """Return what a trial of two joints leaves, the second sliding: residuals of a size, angles that far off."""
    t = DT * np.arange(N)
    q = np.column_stack([np.sin(t + number), 0.1 * np.cos(2.0 * t)])
    dq = np.column_stack([np.cos(t + number), -0.2 * np.sin(2.0 * t)])
    trial = SimpleNamespace(t=t, q=q, name=f"trial {number}")
    motion = SimpleNamespace(
        trial=trial,
        learn=learn,
        number=number,
        t=t + 5.0 * number,
        dt_s=DT,
        q=q,
        dq=dq,
        ddq=-q,
        direction=np.sign(dq),
    )
    before = size * np.column_stack([dq[:, 0], 2.0 * np.sign(dq[:, 1])])
    before[:10] = np.nan
    return Trace(motion, [before, 0.1 * before], [] if learn else [q + angle, q - 0.5 * angle])


@pytest.fixture
def all_traces() -> list[Trace]:
    """Two trials that were learnt from, the worst of all, and four evaluating ones."""
    learnt = [trace(k, 90.0, learn=True) for k in (1, 2)]
    return [*learnt, *(trace(3 + k, size, angle=0.1 * (k + 1)) for k, size in enumerate((2.0, 4.0, 1.0, 3.0)))]


@pytest.fixture
def found() -> SimpleNamespace:
    joints = SimpleNamespace(type="revolute"), SimpleNamespace(type="prismatic")
    regression = SimpleNamespace(
        arm=SimpleNamespace(n_joint=2, joints=joints), weighting=SimpleNamespace(seen_hz=SEEN_HZ)
    )
    depends = SimpleNamespace(joint=1, depends_on=("dq1",))
    return SimpleNamespace(regression=regression, finding=SimpleNamespace(discrepancy=depends))


@pytest.fixture
def drawn(monkeypatch: pytest.MonkeyPatch) -> list[Figure]:
    """Return the figures that are made into pictures."""
    figures: list[Figure] = []
    monkeypatch.setattr(diagnosis_figures, "png", lambda figure: figures.append(figure) or b"png")
    return figures


def lines(panel: object, colour: str) -> list[np.ndarray]:
    return [line.get_ydata() for line in panel.lines if to_hex(line.get_color()) == colour]


def test_torque_is_drawn_of_the_three_worst_judging_trials(found, all_traces, drawn) -> None:
    assert residual_figure(found, all_traces) == b"png"
    axes = np.array(drawn[0].axes).reshape(2, 3)
    assert [panel.get_title() for panel in axes[0]] == ["trial 4", "trial 6", "trial 3"]
    for column, one in zip(axes.T, (all_traces[3], all_traces[5], all_traces[2]), strict=True):
        for j, panel in enumerate(column):
            (before,), (after,) = lines(panel, BEFORE), lines(panel, AFTER)
            np.testing.assert_array_equal(before, one.residuals[0][:, j])
            np.testing.assert_array_equal(after, one.residuals[1][:, j])
    assert [panel.get_ylabel() for panel in axes[:, 0]] == ["torque left 1 [N m]", "torque left 2 [N]"]
    assert [panel.get_xlabel() for panel in axes[:, 0]] == ["", "time in the trial [s]"]


def test_angles_are_drawn_where_they_are_farthest_apart(found, all_traces, drawn) -> None:
    angles_figure(found, all_traces)
    axes = np.array(drawn[0].axes).reshape(4, 3)
    assert [panel.get_title() for panel in axes[0]] == ["trial 6", "trial 5", "trial 4"]
    one = all_traces[5]
    for j, scale in enumerate((180.0 / np.pi, 1000.0)):
        above, below = axes[2 * j, 0], axes[2 * j + 1, 0]
        np.testing.assert_allclose(lines(above, MEASURED)[0], scale * one.motion.trial.q[:, j])
        for colour, off in ((BEFORE, 0.4), (AFTER, -0.2)):
            np.testing.assert_allclose(lines(above, colour)[0], scale * (one.motion.trial.q[:, j] + off))
            np.testing.assert_allclose(lines(below, colour)[0], scale * off)
    labels = ["joint 1 [deg]", "error [deg]", "joint 2 [mm]", "error [mm]"]
    assert [panel.get_ylabel() for panel in axes[:, 0]] == labels


def test_where_the_error_lives_is_drawn_of_the_judging_trials(found, all_traces, drawn) -> None:
    places_figure(found, all_traces)
    axes = np.array(drawn[0].axes).reshape(2, 7)
    labels = ["q1 [rad]", "dq1 [rad/s]", "ddq1 [rad/s²]", "time of the run [s]", "sign(dq1)"]
    assert [panel.get_xlabel() for panel in axes[0, :5]] == labels
    assert [panel.get_xlabel() for panel in axes[1, :3]] == ["q2 [m]", "dq2 [m/s]", "ddq2 [m/s²]"]
    judging = all_traces[2:]
    residual = np.concatenate([one.residuals[0][:, 0] for one in judging])
    speed = np.concatenate([one.motion.dq[:, 0] for one in judging])[np.isfinite(residual)]
    residual = residual[np.isfinite(residual)]
    means = lines(axes[0, 1], BEFORE)[0]
    assert len(means) == 24 and means.mean() == pytest.approx(residual.mean())
    order = np.argsort(speed, kind="stable")
    np.testing.assert_allclose(means[0], residual[order[: len(order) // 24]].mean())
    np.testing.assert_allclose(lines(axes[0, 1], AFTER)[0], 0.1 * means)


def test_friction_is_drawn_by_its_sign(found, all_traces, drawn) -> None:
    places_figure(found, all_traces)
    panel = np.array(drawn[0].axes).reshape(2, 7)[1, 4]
    for k, colour in enumerate((BEFORE, AFTER)):
        points = [line for line in panel.lines if line.get_marker() == "o" and to_hex(line.get_color()) == colour]
        assert [line.get_xdata()[0] for line in points] == pytest.approx([-1.0 + 0.2 * k, 1.0 + 0.2 * k])
        below, above = (line.get_ydata()[0] for line in points)
        assert below < 0.0 < above == pytest.approx(-below, rel=0.2)
        assert above == pytest.approx((5.0, 0.5)[k], rel=0.1)


def test_the_spectrum_is_the_root_of_the_mean_power(found, all_traces, drawn) -> None:
    places_figure(found, all_traces)
    panel = np.array(drawn[0].axes).reshape(2, 7)[0, 5]
    (line,) = [line for line in panel.lines if to_hex(line.get_color()) == BEFORE]
    f = line.get_xdata()
    assert f[0] > 0.0 and f[-1] == pytest.approx(SEEN_HZ) and panel.get_yscale() == "log"
    left = [np.nan_to_num(one.residuals[0][:, 0]) for one in all_traces[2:]]
    powers = [periodogram(one, 1.0 / DT, detrend=False)[1] for one in left]
    np.testing.assert_allclose(line.get_ydata(), np.sqrt(np.mean(powers, axis=0))[1 : len(f) + 1])


def test_every_trial_has_its_rms(found, all_traces, drawn) -> None:
    all_traces[2].residuals[0][:] = np.nan  # stuck all the time
    places_figure(found, all_traces)
    panel = np.array(drawn[0].axes).reshape(2, 7)[0, 6]
    drawn_before = [line for line in panel.lines if to_hex(line.get_color()) == BEFORE]
    points = {line.get_xdata()[0]: line.get_ydata()[0] for line in drawn_before}
    assert list(points) == [1, 2, 4, 5, 6]
    assert points[4] == pytest.approx(np.sqrt(np.nanmean(all_traces[3].residuals[0][:, 0] ** 2)))
    (shade,) = panel.patches
    box = shade.get_extents().transformed(panel.transData.inverted())
    assert (box.x0, box.x1) == pytest.approx((0.5, 2.5))
    assert panel.get_xlim() == (0.5, 6.5)


def test_what_is_left_is_drawn_against_what_it_depends_on(found, all_traces, drawn) -> None:
    remainder_figure(found, all_traces)
    (panel,) = drawn[0].axes
    assert (panel.get_xlabel(), panel.get_ylabel()) == ("dq1", "torque left 1 [N m]")
    residual = np.concatenate([one.residuals[1][:, 0] for one in all_traces[2:]])
    assert lines(panel, AFTER)[0].mean() == pytest.approx(np.nanmean(residual)) and not lines(panel, BEFORE)


def test_against_two_variables_a_map_is_drawn(found, all_traces, drawn) -> None:
    found.finding.discrepancy.depends_on = ("dq1", "q2", "t")
    remainder_figure(found, all_traces)
    panel = drawn[0].axes[0]
    assert (panel.get_xlabel(), panel.get_ylabel()) == ("dq1", "q2")
    (mesh,) = panel.collections
    seen = mesh.get_array()
    assert seen.shape == (24, 24) and 0 < np.isfinite(seen.filled(np.nan)).sum() < 24 * 24
    low, high = mesh.get_clim()
    assert -low == high == pytest.approx(np.abs(seen).max())
    x = mesh.get_coordinates()[0, :, 0]
    middle = 0.5 * (x[1:] + x[:-1])
    slope = np.ma.polyfit(np.tile(middle, 24), seen.ravel(), 1)[0]
    assert 0.1 < slope < 0.4  # a tenth of what is left of each newton metre a radian a second


def test_a_dozen_gains_are_drawn_the_best_on_top(drawn) -> None:
    gains_figure([f"effect {k}" for k in range(15)], [0.9 - 0.05 * k for k in range(15)], [BEFORE] * 15)
    (panel,) = drawn[0].axes
    assert [bar.get_width() for bar in panel.patches] == pytest.approx([90.0 - 5.0 * k for k in range(12)])
    assert [text.get_text() for text in panel.get_yticklabels()] == [f"effect {k}" for k in range(12)]
    low, high = panel.get_ylim()
    assert low > high and panel.get_xlim() == (0.0, 100.0)


def test_panels_lie_within_the_picture_and_apart(found, all_traces, drawn) -> None:
    residual_figure(found, all_traces)
    boxes = [panel.get_position() for panel in drawn[0].axes]
    wide = drawn[0].get_size_inches()[0]
    assert wide * boxes[0].x0 == pytest.approx(0.8)  # inches, for the labels
    assert wide * (boxes[1].x0 - boxes[0].x1) == pytest.approx(0.15)
    assert wide * (1.0 - boxes[2].x1) == pytest.approx(0.15)
    high = drawn[0].get_size_inches()[1]
    assert high * boxes[3].y0 == pytest.approx(0.5) and high * (1.0 - boxes[0].y1) == pytest.approx(0.3)
