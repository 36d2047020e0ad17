"""What the benchmark of hidden pulses takes for known."""

import numpy as np
import pytest

from arm.arm_file import load_arm
from benchmarks.pulses import ARM, STEP_S, load, residuals
from fitter.data.derivatives import settling_samples

BAND_HZ = 10.0


@pytest.fixture
def run(tmp_path):
    """Return a run that ends while the arm still moves."""
    t = np.arange(0.0, 4.0, STEP_S)
    q = np.stack([np.sin(7.0 * t), np.cos(5.0 * t) + 0.5 * t], axis=1)
    columns = {"time": t, "pos_meas1": q[:, 0], "pos_meas2": q[:, 1]}
    columns |= {"tau_meas1": 0.5 * np.sin(7.0 * t), "tau_meas2": 0.2 * np.cos(5.0 * t)}
    columns |= {"tau_pert1": 0.0 * t, "tau_pert2": 0.0 * t}
    path = tmp_path / "swing.csv"
    table = np.stack(list(columns.values()), axis=1)
    np.savetxt(path, table, delimiter=",", header=",".join(columns), comments="")
    return load(path, load_arm(str(ARM)), BAND_HZ)


def test_nothing_is_known_where_the_filter_guesses_beyond_a_run(run):
    [residual] = residuals([run], BAND_HZ)
    ends = settling_samples(STEP_S, BAND_HZ)
    assert not residual.known[:ends].any()
    assert not residual.known[-ends:].any()
    assert residual.known[ends:-ends].all()
