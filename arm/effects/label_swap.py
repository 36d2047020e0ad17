"""Two markers that have each other's names, in some trials or in all."""

from dataclasses import replace

from arm.effects.effect import EffectKind, with_markers
from arm.effects.trials import TRIALS
from arm.model import Arm, Effect, Marker


def _change(arm: Arm, effect: Effect) -> Arm:
    one, other = effect.markers
    names = {one: other, other: one}

    def renamed(marker: Marker) -> Marker:
        return replace(marker, name=names[marker.name])

    return with_markers(arm, effect.markers, renamed)


EFFECT = EffectKind(
    name="label_swap",
    sentence="the two markers have each other's names",
    place="marker",
    parameters=(TRIALS,),
    taken_for=("marker_moved",),
    exactly=2,
    marked=_change,
)
