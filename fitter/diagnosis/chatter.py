"""A torque that is mostly noise: nothing smaller can be told, and whoever reads the verdict has to know."""

from collections.abc import Sequence

import numpy as np

from arm.model import Arm
from fitter.data.trials import Trial
from fitter.diagnosis.motion import white_noise

#: A torque of which more than this share of its rms is white is mostly noise, or a drive that chatters.
_MOSTLY = 0.5


def chatter(arm: Arm, trials: Sequence[Trial]) -> list[str]:
    """Return a sentence for every joint whose measured torque changes from sample to sample as noise does.

    Parameters
    ----------
    arm : Arm
    trials : sequence of Trial
    """
    measured = [trial.whole["tau"] for trial in trials if "tau" in trial.whole]
    if not measured:
        return []
    white = white_noise(measured)
    size = np.sqrt(np.mean(np.concatenate(measured) ** 2, axis=0))
    return [
        f"the torque at joint {j + 1} changes from sample to sample like noise ({white[j]:.3g} {unit} of "
        f"{size[j]:.3g} {unit} rms): what is smaller than that cannot be told; a drive that chatters looks so"
        for j, unit in enumerate("N m" if joint.type == "revolute" else "N" for joint in arm.joints)
        if white[j] > _MOSTLY * size[j] > 0.0
    ]
