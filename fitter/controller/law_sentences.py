"""What a fit of arm and law rests on and what it can't part, in words."""

from collections.abc import Mapping

import numpy as np

from fitter.controller.law_fit import LawFit
from fitter.controller.law_forms import describe


def fixed_by(known: Mapping[str, float], anchors: Mapping[str, float], measured_torque: bool) -> str:
    """Say which number the common factor rests on.

    Parameters
    ----------
    known : mapping from name to value
        What was given.
    anchors : mapping from name to value
        What was taken from the arm file, where nothing was given.
    measured_torque : bool
    """
    scaled = "all other masses, frictions and gains scale with"
    if measured_torque:
        return f"the measured torque fixes the common factor; {scaled} it"
    if known:
        said = ", ".join(f"{name} = {value:g}" for name, value in known.items())
        return f"given, {said} fix{'' if len(known) > 1 else 'es'} the common factor; {scaled} it"
    said = ", ".join(f"{name} = {value:g}" for name, value in anchors.items())
    return (
        f"nothing was given, so {said} of the arm file is taken for the truth; {scaled} it, and the motion is the "
        "same whatever it is"
    )


def only_together(fit: LawFit) -> tuple[str, ...]:
    """Say what a fit tells of parameters that the data cannot distinguish, one sentence each."""
    said = []
    std, names = fit.std(), fit.columns.names
    for weights in fit.ambiguity.combinations():
        leader = next(iter(weights))
        text, values = "", fit.values.copy()
        values[leader] = sum(weight * fit.values[k] for k, weight in weights.items())
        for k, weight in weights.items():
            factor = "" if np.isclose(abs(weight), 1.0, atol=1e-6) else f"{abs(weight):.4g} "
            text += (" - " if weight < 0.0 else " + " if text else "") + factor + names[k]
        held = ", ".join(names[k] for k in weights if k != leader)
        estimate = describe(fit.columns, values, std, names[leader])
        said.append(f"{text} = {estimate}; {held} keeps the arm file's value")
    trades = zip(fit.ambiguity.folded, fit.ambiguity.trades, strict=True)
    silent = [k for k, row in trades if np.count_nonzero(row) == 1]
    said += [f"{names[k]} does not show by itself in this motion and keeps the arm file's value" for k in silent]
    return tuple(said)
