"""Pushes: when there were any is part of the finding, as it is of loads (`payload`).

They are sought over the whole run, learning and evaluating trials alike, for a trial that was not affected says
nothing of them, and one that was cannot be predicted from others.
"""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from arm.effects.effect import EffectKind
from arm.model import Floats
from fitter.diagnosis.hypothesis import Hypothesis
from fitter.diagnosis.motion import Motion
from fitter.diagnosis.torque.pulse import Pulse, pulse_means
from fitter.diagnosis.view import View

_NUMBERS = ("start_s", "duration_s", "torque_N_m")


class Pushes(Hypothesis):
    """Some pushes at one joint.

    Parameters
    ----------
    kind : EffectKind
    joint : int
    found : sequence of Pulse
        On the run's clock. They are known torques: their size is what the search found beside the coloured
        background, which a fit of white residuals does not know.
    """

    is_event = True
    is_inertial = False
    comes_and_goes = True
    is_noisy = False

    def __init__(self, kind: EffectKind, joint: int, found: Sequence[Pulse]) -> None:
        super().__init__(kind, (joint,))
        self.found = tuple(found)

    @property
    def n_number(self) -> int:
        """Start, duration and torque of each."""
        return len(_NUMBERS) * len(self.found)

    def act(self, view: View, psi: Floats) -> View:
        """Return a motion that the pushes drove, too."""
        u, motion = view.u.copy(), view.motion
        for one in self.found:
            shape = pulse_means(motion.t, motion.dt_s, one.start_s, one.duration_s, one.form)
            u[:, self.joints[0]] += one.torque_N_m * shape
        return replace(view, u=u)

    def numbers(self, psi: Floats, factors: Floats) -> Floats:
        """Return start, duration and torque of each push."""
        return np.ravel([[getattr(one, name) for name in _NUMBERS] for one in self.found])

    def hidden(self, motions: Sequence[Motion], values: Floats) -> Floats:
        """Return the standard errors with which the pushes were found: the fit has no number of theirs."""
        return np.ravel([[one.start_std, one.duration_std, one.torque_std] for one in self.found])

    @property
    def names(self) -> tuple[str, ...]:
        """Numbered where there are several pushes."""
        names = [parameter.name for parameter in self.kind.parameters]
        if len(self.found) == 1:
            return tuple(names)
        return tuple(f"{name}_{k + 1}" for k in range(len(self.found)) for name in names)

    @property
    def units(self) -> tuple[str, ...]:
        """Of each."""
        return tuple(parameter.unit for parameter in self.kind.parameters) * len(self.found)
