"""What `fitter compile` goes through: every method of tracking, over a gap, and what tracks last."""

import numpy as np
import pytest

from fitter.commands import kernels
from fitter.data.gaps import find_gaps


def test_every_way_is_gone_with_motion_gap_and_measured_torque(monkeypatch: pytest.MonkeyPatch) -> None:
    gone: list[tuple[object, ...]] = []
    monkeypatch.setattr(kernels, "limb_warm_up", lambda: gone.append(("limb",)))
    monkeypatch.setattr(kernels, "marker_warm_up", lambda: gone.append(("markers",)))
    monkeypatch.setattr(kernels, "diagnosis_warm_up", lambda: gone.append(("diagnosis",)))
    monkeypatch.setattr(kernels, "reading_warm_up", lambda: gone.append(("readings",)))
    monkeypatch.setattr(kernels.live, "warm_up", lambda: gone.append(("live",)))
    monkeypatch.setattr(kernels, "fit_dynamics", lambda *a, **b: gone.append(("fit", *a, b)))
    monkeypatch.setattr(kernels, "track_run", lambda *a: gone.append(("track", *a)))
    monkeypatch.setattr(kernels.DiscrepancySmoother, "smooth", lambda _, readings: gone.append(("lack", readings)))
    kernels.compile_all()
    first = ["limb", "markers", "diagnosis", "readings", "fit", "live"]
    assert [one[0] for one in gone] == [*first, "track", "track", "track", "lack"]
    _, arm, trials, options = gone[4]
    assert arm.control.law == "measured" and options == {"seed": 0, "examine": False}
    assert len(trials) == 1 and np.ptp(trials[0].q, axis=0).min() > 0.01 and trials[0].tau is not None
    assert {one[5] for one in gone[6:9]} == {"integrate", "filter", "smooth"}
    for _, run, _, start, rate_hz, _ in gone[6:9]:
        dt_s, gaps = find_gaps(run.t)
        assert gaps == run.gaps and len(gaps) == 1 and run.lost > 0
        assert run.rate_hz == pytest.approx(1.0 / dt_s) and 0.0 < rate_hz <= run.rate_hz
        assert run.a.shape == (len(run.t), 3 * len(arm.sensors)) and np.isfinite(run.a).all()
        assert np.linalg.norm(run.a[0, :3]) == pytest.approx(9.81, abs=0.3)  # m/s^2, no counts
        assert start.shape == (arm.n_joint,)
    assert np.isfinite(gone[9][1].values).all() and len(gone[9][1].values) > 10
