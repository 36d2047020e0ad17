"""What one draw of noise makes of the equations under a model, computed once for what it hardly depends on."""

from collections.abc import Mapping, Sequence

from arm.model import Floats
from fitter.diagnosis.attenuation import Noise, added, noise_of
from fitter.diagnosis.hypothesis import Hypothesis
from fitter.diagnosis.model import Model
from fitter.diagnosis.motion import Motion
from fitter.diagnosis.rows import Equations


class NoisyRows:
    """What one draw of noise makes of equations.

    Parameters
    ----------
    equations : Equations
    noisier : mapping of int to Motion
        The same motions by their numbers, with one draw of noise more.
    """

    def __init__(self, equations: Equations, noisier: Mapping[int, Motion]) -> None:
        self._equations, self._noisier = equations, noisier
        self.known: dict[object, Noise] = {}

    def of(self, model: Model, motions: Sequence[Motion]) -> Noise:
        """Return what the draw makes of the equations of some motions under a model."""
        found = []
        for motion in motions:
            parts = zip(model.hypotheses, model.psi, strict=True)
            key = motion.number, *((one.part_of(motion), *_key(one, psi)) for one, psi in parts)
            if key not in self.known:
                self.known[key] = self._of(model, motion)
            found.append(self.known[key])
        return added(found)

    def _of(self, model: Model, motion: Motion) -> Noise:
        rows, loud = (self._equations.rows(model, one) for one in (motion, self._noisier[motion.number]))
        columns = (loud.design - rows.design).reshape(*rows.target.shape, -1)
        at = columns.shape[2] - model.n_column
        for hypothesis, psi in zip(model.hypotheses, model.psi, strict=True):
            if len(psi) or not hypothesis.is_noisy:  # these columns are hardly noisy, and change with psi
                columns[:, :, at : at + hypothesis.n_column] = 0.0
            at += hypothesis.n_column
        return noise_of(columns, loud.target - rows.target)


def _key(hypothesis: Hypothesis, psi: Floats) -> tuple[object, ...]:
    """Return what tells hypotheses apart by what they make of noise.

    psi hardly matters but where it scales it, or turns the columns among themselves: noise that stayed behind
    would make one zero of a joint seem better than another where they all are the same.
    """
    matters = hypothesis.kind.name in ("gain_error", "joint_zero", "gravity_tilt")
    return hypothesis.key, hypothesis.n_column, psi.tobytes() if matters else b""
