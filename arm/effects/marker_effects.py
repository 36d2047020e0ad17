"""What an arm's effects do to its markers, trial by trial."""

from collections.abc import Mapping
from dataclasses import replace

from arm.effects.catalogue import catalogue
from arm.effects.check import effect_mistakes
from arm.effects.trials import acts_in
from arm.model import Arm, Floats
from limbcal.errors import ConfigError


def marked_in(arm: Arm, trial: int) -> Arm:
    """Return the arm with its markers as they are in a trial, counted from 1, and its effects of that trial.

    Raises
    ------
    ConfigError
        If an effect is not as the catalogue has it.
    """
    if arm.effects and (mistakes := effect_mistakes(arm)):
        raise ConfigError(mistakes)
    acting = [effect for effect in arm.effects if acts_in(effect.parameters, trial)]
    for effect in acting:
        change = catalogue()[effect.name].marked
        if change is not None:
            arm = change(arm, effect)
    return replace(arm, effects=tuple(acting))


def slid_markers(arm: Arm, q: Floats) -> Mapping[str, Floats]:
    """Return by how much markers have slid on their links, (n_sample, 3) [m], of those that do.

    Parameters
    ----------
    arm : Arm
        As `marked_in` has it.
    q : (n_sample, n_joint) [rad or m]
    """
    moved: dict[str, Floats] = {}
    for effect in arm.effects:
        slid = catalogue()[effect.name].slid
        if slid is not None:
            for name in effect.markers:
                moved[name] = moved.get(name, 0.0) + slid(effect, q)
    return moved
