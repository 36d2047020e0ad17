"""A search for causes by simulated motion: for arms whose torque nobody measured.

Each candidate is added to the model and all numbers are fitted to the motion that is learnt from; the best is
taken if it lowers the squared error of that motion by `WORTH`. The motion held back has no say in it.
"""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace

from arm.effects.catalogue import catalogue
from arm.model import Arm, Effect, Floats
from examples.cases.motion_fit import Refined, refined

WORTH, MOST = 0.05, 5
#: Steps of the fit while candidates are compared; the best is then fitted to the end.
_TRIED = 4

#: Names and numbers of effects to start from.
Candidates = Mapping[str, Mapping[str, float]]


def search(
    start: Arm,
    errors: Callable[[Arm], Floats],
    candidates: Candidates,
    most: int = MOST,
    known_inertia: bool = False,
) -> list[Refined]:
    """Return the models that the search went through, from the first without causes to the last.

    Parameters
    ----------
    start : Arm
    errors : callable
        Simulated less measured angles of an arm, (n_stretch, …) or flat [rad].
    candidates : mapping
    most : int
        So many causes, and no more.
    known_inertia : bool
        As for `refined`.
    """
    effects = [
        Effect(name, dict(values), joints=(j + 1,))
        for name, values in candidates.items()
        for j in range(start.n_joint)
    ]
    models = [refined(start, errors, known_inertia)]
    while len(models) <= most:
        before = models[-1]
        there = {(effect.name, effect.joints) for effect in before.arm.effects}
        tried = [
            refined(replace(before.arm, effects=(*before.arm.effects, one)), errors, known_inertia, _TRIED)
            for one in effects
            if (one.name, one.joints) not in there
        ]
        if not tried:
            break
        best = refined(min(tried, key=lambda one: one.square).arm, errors, known_inertia)
        if best.square > (1.0 - WORTH) * before.square:
            break
        models.append(best)
    return models


def name_of(model: Refined) -> str:
    """Return what was added last."""
    effect = model.arm.effects[-1]
    return f"+ {effect.name}, joint {effect.joints[0]}"


def causes_told(models: Sequence[Refined], candidates: Candidates, unit: str = "N m") -> list[str]:
    """Return lines on the causes in the order found, with sizes and what each takes away."""
    final, lines = models[-1], []
    for k, effect in enumerate(final.arm.effects):
        kind = catalogue()[effect.name]
        sizes = [
            f"`{parameter.name}` {effect.parameters[parameter.name]:.3g} "
            f"± {1.96 * final.std[k, parameter.name]:.1g} {parameter.unit}"
            for parameter in kind.parameters
        ]
        share = 100.0 * (1.0 - models[k + 1].square / models[k].square)
        lines.append(
            f"{k + 1}. **{effect.name}, joint {effect.joints[0]}**: {kind.sentence}. "
            f"{'; '.join(sizes).replace('N m', unit)}. It takes away {share:.0f} % of the squared error learnt "
            "from."
        )
    return [
        *lines,
        "",
        "Sizes are those in the model with all causes, ± half of their 95 % interval over stretches of motion. "
        "Nobody "
        "measured a torque, and what counts here is motion: so candidates "
        f"({', '.join(candidates)}; at every joint) were each fitted to the simulated motion of what is learnt "
        "from, "
        "with all other numbers of the arm, and the best was taken as long as the squared error fell by "
        f"{100 * WORTH:.0f} %. What is held back has no say in it (`examples/cases/motion_search.py`). This is "
        "not "
        "the search of `fitter diagnose`, which compares torques.",
    ]
