"""Pictures, whatever is to be drawn."""

import io

import matplotlib.image
import numpy as np
import pytest

from fitter.report.figures import Comparison, angles_figure, error_figure

T = np.linspace(0.0, 2.0, 80)
MEASURED = np.column_stack([np.sin(T), 0.5 * T])


def comparison(simulated=None, learnt=True, turning=(True, True)):
    simulated = MEASURED + 0.01 * np.cos(9 * T[:, None]) if simulated is None else simulated
    return Comparison("motion", learnt, T, MEASURED, simulated, turning)


def pixels(png):
    return matplotlib.image.imread(io.BytesIO(png))


@pytest.mark.parametrize("draw", [angles_figure, error_figure])
def test_a_picture_is_the_same_for_the_same_motions(draw):
    motions = [comparison(), comparison(learnt=False)]
    png = draw(motions)
    assert png == draw(motions)
    assert png.startswith(b"\x89PNG")
    assert b"atplotlib" not in png  # no version, so no other bytes with the next one
    assert np.ptp(pixels(png)[..., :3]) > 0.5


def test_a_picture_has_a_row_a_joint():
    three = Comparison("m", True, T, np.tile(MEASURED[:, :1], 3), np.tile(MEASURED[:, 1:], 3), (True,) * 3)
    assert pixels(angles_figure([three])).shape[0] > pixels(angles_figure([comparison()])).shape[0]


def test_both_angles_can_be_told_apart():
    shown = pixels(angles_figure([comparison(simulated=MEASURED + 0.4)]))
    for colour in ("e07b00", "a61c3c"):
        rgb = np.array([int(colour[k : k + 2], 16) for k in (0, 2, 4)]) / 255
        assert np.any(np.all(np.abs(shown[..., :3] - rgb) < 0.02, axis=-1)), colour


RAN_AWAY = np.where(np.arange(80)[:, None] > 40, np.inf, MEASURED)


@pytest.mark.parametrize(
    ("simulated", "turning"),
    [
        (MEASURED, (False, False)),
        (RAN_AWAY, (True, True)),
        (np.where(RAN_AWAY == np.inf, 1e300, RAN_AWAY), (True, False)),
        (np.full_like(MEASURED, np.nan), (True, True)),
    ],
    ids=["exact", "infinite", "huge", "nothing"],
)
def test_no_motion_is_beyond_drawing(simulated, turning):
    motions = [comparison(simulated, turning=turning), comparison(learnt=False, turning=turning)]
    for draw in (angles_figure, error_figure):
        assert draw(motions).startswith(b"\x89PNG")
    assert error_figure(motions[:1]).startswith(b"\x89PNG")


def test_what_is_off_by_how_much():
    off = MEASURED + np.array([0.1, 0.02])
    assert np.allclose(comparison(off).error, np.rad2deg([[0.1, 0.02]]))
    assert np.allclose(comparison(off, turning=(True, False)).error, np.rad2deg(0.1))
    assert np.allclose(comparison(off, turning=(False, False)).error, [[100.0, 20.0]])
    assert [comparison(turning=(t, False)).unit for t in (True, False)] == ["deg", "mm"]
    ran_away = comparison(RAN_AWAY)
    assert np.isfinite(ran_away.shown[:41]).all() and np.isnan(ran_away.shown[41:]).all()
