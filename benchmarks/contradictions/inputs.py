"""All inputs of some seeds."""

from collections.abc import Iterator, Sequence

from benchmarks.contradictions import motion_inputs, reading_inputs, torque_inputs
from benchmarks.contradictions.drawn import Case, draw

KINDS = (
    motion_inputs.faultless,
    torque_inputs.signs,
    motion_inputs.turns,
    motion_inputs.degrees,
    motion_inputs.clocks,
    torque_inputs.units,
    motion_inputs.geometry,
    reading_inputs.accelerations,
    torque_inputs.others,
    torque_inputs.saturated_and_late,
    motion_inputs.encoders,
    torque_inputs.laws,
)


def cases(seeds: Sequence[int]) -> Iterator[Case]:
    """Yield the inputs of each seed, kind by kind."""
    for seed in seeds:
        drawn = draw(seed)
        for kind in KINDS:
            yield from kind(drawn)
