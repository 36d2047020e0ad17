"""A pendulum's trials as the torque likelihood sees them, with and without an effect in them."""

from arm.model import Effect
from fitter.data.trials import to_trials
from fitter.diagnosis.motion import run_of
from fitter.diagnosis.torque.likelihood import TorqueLikelihood
from tests.fitter.pendulum import pendulum, swings


def likelihood(effects: tuple[Effect, ...] = ()) -> TorqueLikelihood:
    """Return the likelihood of eight trials, four of which may be learnt from."""
    trials = to_trials(swings(effects, trials=8, seed=2), cutoff_hz=25.0)
    return TorqueLikelihood(pendulum(), run_of(pendulum(), trials[:4], trials[4:]))
