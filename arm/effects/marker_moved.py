"""A marker that sits elsewhere on its link than was said, in some trials or in all."""

from dataclasses import replace

from arm.effects.effect import EffectKind, Parameter, total, vector, with_markers
from arm.effects.trials import TRIALS
from arm.model import Arm, Effect, Marker

_AXES = ("x_m", "y_m", "z_m")


def _change(arm: Arm, effect: Effect) -> Arm:
    added = vector(effect.parameters, *_AXES)

    def moved(marker: Marker) -> Marker:
        return replace(marker, position_m=total(marker.position_m, added))

    return with_markers(arm, effect.markers, moved)


EFFECT = EffectKind(
    name="marker_moved",
    sentence="the marker sits elsewhere on its segment than was said",
    place="marker",
    parameters=(
        *(Parameter(name, "m", -1.0, 1.0, linear=True, neutral=0.0) for name in _AXES),
        TRIALS,
    ),
    taken_for=("soft_tissue", "label_swap"),
    marked=_change,
)
