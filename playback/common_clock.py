"""Whether two motions are on one clock, and how far apart their trials begin on it."""

from collections.abc import Mapping

from limbcal.note import Note
from playback.source import Source

Spans = Mapping[int, tuple[float, float]]

#: Beginnings that are no further apart are one [s]: a date in ns since 1970 is kept to 0.24 us.
_SAME_S = 1e-6


def spans_of(begins_s: Mapping[int, float], durations_s: Mapping[int, float]) -> Spans:
    """Return when each trial began and ended, on the clock of what was read [s]."""
    begins = {trial: begins_s.get(trial, 0.0) for trial in durations_s}
    return {trial: (begins[trial], begins[trial] + length) for trial, length in durations_s.items()}


def begins_after(source: Source, other: Spans, name: str) -> tuple[dict[int, float], tuple[Note, ...]]:
    """Return by how much each trial that both have begins later than that of a source [s], and what to say of it.

    Two motions are on one clock if each of their common trials overlaps. One whose clock starts anew with every
    trial is on none with one whose clock goes on; then all trials begin together.

    Parameters
    ----------
    source : Source
    other : mapping of int to (float, float)
        When the other's trials began and ended.
    name : str
        The other's, for notes.
    """
    own = spans_of(source.begins_s, source.durations_s)
    common = sorted(own.keys() & other.keys())
    later = {trial: other[trial][0] - own[trial][0] for trial in common}
    later = {trial: by if abs(by) > _SAME_S else 0.0 for trial, by in later.items()}
    if not any(later.values()):
        return later, ()
    apart = [k for k in common if max(own[k][0], other[k][0]) >= min(own[k][1], other[k][1])]
    if apart or _goes_on(own) != _goes_on(other):
        trial = apart[0] if apart else next(k for k in common if later[k])
        spans = f"from {_seconds(own[trial])} in {source.name} and from {_seconds(other[trial])} in {name}"
        text = f"trial {trial} is {spans}, so they are on no common clock: trials of both are begun together"
        return dict.fromkeys(common, 0.0), (Note("clock", text),)
    said = ", ".join(
        f"trial {trial} begins {abs(by):.6g} s {'later' if by > 0.0 else 'earlier'}"
        for trial, by in later.items()
        if by
    )
    return later, (Note("clock", f"by the clock of {source.name} and {name}, in the latter {said}"),)


def _goes_on(spans: Spans) -> bool:
    """Say whether trials follow one another on the clock."""
    order = sorted(spans.values())
    return all(before[1] <= after[0] for before, after in zip(order, order[1:], strict=False))


def _seconds(span: tuple[float, float]) -> str:
    return f"{span[0]:.9g} to {span[1]:.9g} s"
