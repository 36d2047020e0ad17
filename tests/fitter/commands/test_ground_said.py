"""What `fitter dynamics --ground` says, of one body whose numbers are easily reckoned with."""

from collections.abc import Iterator
from types import SimpleNamespace

import numpy as np
import pytest
from rich.console import Console

from fitter.commands.ground_said import say_ground
from fitter.ground.ground_score import GroundScore
from fitter.ground.plate_calibration import PlateCalibration
from fitter.search.fitted_parameter import FittedParameter
from limbcal import command

NAMES = tuple(f"{kind}1" for kind in ("Ixx", "Iyy", "Izz", "Ixy", "Ixz", "Iyz", "mx", "my", "mz", "m"))


@pytest.fixture(autouse=True)
def wide() -> Iterator[None]:
    """Let rows fit into a line."""
    token = command._answers.set(Console(width=200))
    yield
    command._answers.reset(token)


def fit(learnt: float) -> SimpleNamespace:
    """Return a body of 4 kg, its centre at 0.1 m, radii of gyration 0.2, 0.1 and 0.3 m about that."""
    m, x = 4.0, 0.1
    own = m * np.array([0.2**2, 0.1**2, 0.3**2])
    theta = np.concatenate([own + [0.0, m * x * x, m * x * x], np.zeros(3), [m * x, 0.0, 0.0, m]])
    prior = np.full(10, 0.04)
    return SimpleNamespace(
        arm=SimpleNamespace(name="person [1]"),
        samples=500,
        band_hz=6.0,
        total_kg=(4.0, 0.1),
        names=NAMES,
        base=SimpleNamespace(bodies=(1,)),
        values=theta,
        before=theta,
        covariance=np.diag((1.0 - learnt) * prior),
        prior_covariance=np.diag(prior),
        learnt=np.full(10, learnt),
        parameters={name: FittedParameter(1.0, 0.1, "kg", False) for name in NAMES},
        plates=PlateCalibration(np.array([0.0, 0.0, 0.0, 2.5, -1.0, 0.0]), np.full(6, 0.5)),
        combinations=[SimpleNamespace(terms={"m1": 1.0, "mx1": -1.0, "my1": 0.1})],
    )


def said(capsys: pytest.CaptureFixture[str]) -> str:
    out, err = capsys.readouterr()
    return " ".join((out + err).split())


def test_each_segment_has_mass_centre_and_radii(capsys: pytest.CaptureFixture[str]) -> None:
    say_ground(fit(0.75), {"learn": None}, ["pelvis", "thigh"], prior=True)
    text = said(capsys)
    assert "person [1]: 500 samples up to 6 Hz, 4.00 ± 0.20 kg in all" in text
    row = text[text.index("thigh") :].split("│")
    assert "pelvis" not in text
    mass, half, centre, reach, radii, learnt = (part.strip() for part in row[1:7])
    assert (mass, half, centre, radii, learnt) == ("4.00", "0.20", "100 0 0", "200 100 300", "0.75 0.75 0.75")
    first = 1e3 * 1.96 * 0.1 * np.sqrt(1.0 + 0.1**2) / 4.0  # of mx / m, by its slopes
    assert reach == f"{first:.0f} {1e3 * 1.96 * 0.1 / 4.0:.0f} {1e3 * 1.96 * 0.1 / 4.0:.0f}"
    assert "0 of 10 parameters are left at the prior" in text
    assert "1 combinations are known only together, such as m1 with mx1" in text and "my1" not in text


def test_without_a_prior_nothing_is_said_of_one(capsys: pytest.CaptureFixture[str]) -> None:
    say_ground(fit(0.75), {}, ["pelvis", "thigh"], prior=False)
    text = said(capsys)
    assert "left at the prior" not in text and "learnt" not in text and "0.75" not in text


def test_what_the_ground_hardly_tells_is_counted(capsys: pytest.CaptureFixture[str]) -> None:
    say_ground(fit(1e-4), {}, ["pelvis", "thigh"], prior=True)
    assert "10 of 10 parameters are left at the prior: they are the table's, not measured" in said(capsys)


def test_scores_are_said_of_the_trials_that_there_are(capsys: pytest.CaptureFixture[str]) -> None:
    score = GroundScore((40.0, 20.0, 10.0), (8.0, 16.0, 8.0), np.zeros(6), np.zeros(6))
    say_ground(fit(0.5), {"learn": None, "evaluate": score}, ["pelvis", "thigh"], prior=False)
    text = said(capsys)
    assert (
        "evaluating trials: the ground's force is off by 20.0 N rms (40.0 as it was, squared -75 %), its moment "
        "about the base link by 16.0 N m (8.0, squared +300 %); with what the plates are off by 10.0 N "
        "(-94 %) and 8.0 N m (-0 %)" in text
    )
    assert "the plates read 2.50 ± 0.98, -1.00 ± 0.98, 0.00 ± 0.98 N along x, y and z of frame 0 too much" in text
    assert "learning trials" not in text
