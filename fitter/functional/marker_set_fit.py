"""How a marker set fits the markers of a recording, marker by marker."""

import re
from collections.abc import Sequence
from dataclasses import dataclass

from fitter.functional.marker_set import MarkerSet, load_marker_set, marker_set_names
from limbcal.note import Note
from limbcal.suggestion import did_you_mean

#: Markers of one segment that give it a pose of its own.
_POSE = 3
#: Share of a set's markers below which it is more likely another set than an incomplete one.
_WRONG_SET = 0.5


@dataclass(frozen=True)
class MarkerSetFit:
    """Which markers of a set a recording has, and which not.

    Attributes
    ----------
    segments : dict of str to tuple of str
        The markers that are there, by segment; segments with none are left out.
    landmarks : dict of str to str
        Landmarks whose marker is there.
    missing : tuple of str
        Markers of the set that the recording has not.
    unused : tuple of str
        Markers of the recording that the set has not.
    notes : tuple of Note
        One for each missing marker, with what it may be called here, and one for those that are not used.
    """

    segments: dict[str, tuple[str, ...]]
    landmarks: dict[str, str]
    missing: tuple[str, ...]
    unused: tuple[str, ...]
    notes: tuple[Note, ...]

    @property
    def posed(self) -> tuple[str, ...]:
        """Segments with three markers or more, which have a pose of their own."""
        return tuple(segment for segment, markers in self.segments.items() if len(markers) >= _POSE)


def fit_marker_set(marker_set: MarkerSet, markers: Sequence[str]) -> MarkerSetFit:
    """Compare a marker set with the markers of a recording.

    Parameters
    ----------
    marker_set : MarkerSet
    markers : sequence of str
        Of those that were seen in the recording at all.
    """
    there = set(markers)
    segments = {s: tuple(m for m in listed if m in there) for s, listed in marker_set.segments.items()}
    missing = tuple(m for m in marker_set.markers if m not in there)
    unused = tuple(m for m in markers if m not in set(marker_set.markers))
    return MarkerSetFit(
        {segment: found for segment, found in segments.items() if found},
        {landmark: m for landmark, m in marker_set.landmarks.items() if m in there},
        missing,
        unused,
        (
            *_wrong_set(marker_set, missing, markers),
            *(_missing(marker_set, marker, unused) for marker in missing),
            *_unused(marker_set, unused),
            *_too_few(marker_set, segments),
        ),
    )


def best_built_in(markers: Sequence[str]) -> tuple[str, float]:
    """Return the name of the built-in set that fits markers best, and the share of its markers that are there."""
    there = set(markers)
    fits = []
    for name in marker_set_names():
        listed = load_marker_set(name).markers
        found = sum(m in there for m in listed)
        fits.append((found / len(listed), found, name))
    # the share of both, so that a small set that is wholly there does not win over a large one that nearly is
    share, _, name = max(fits, key=lambda fit: (fit[0] * fit[1], fit[2]))
    return name, share


def built_in_advice(markers: Sequence[str]) -> str:
    """Return which built-in set to take for a recording's markers, or that none of them is meant for it."""
    name, share = best_built_in(markers)
    if share >= _WRONG_SET:
        return f"{name} is the built-in set that fits best, of which {100.0 * share:.0f} % are there"
    return (
        f"no built-in set fits: of {name}, the nearest, {100.0 * share:.0f} % are there; `fitter marker-set` "
        "drafts one from a recording in which every joint moves"
    )


def _wrong_set(marker_set: MarkerSet, missing: Sequence[str], markers: Sequence[str]) -> list[Note]:
    listed = marker_set.markers
    found = len(listed) - len(missing)
    if found >= _WRONG_SET * len(listed):
        return []
    name, share = best_built_in(markers)
    better = f"; of {name} there are {100.0 * share:.0f} %" if share > found / len(listed) else ""
    text = (
        f"only {found} of the {len(listed)} markers of marker set {marker_set.name} are in the recording{better}"
    )
    return [Note("wrong_marker_set", text)]


def _missing(marker_set: MarkerSet, marker: str, unused: Sequence[str]) -> Note:
    landmark = next((name for name, one in marker_set.landmarks.items() if one == marker), None)
    on = f" on {marker_set.segment_of(marker)}" + (f", its {landmark}" if landmark else "")
    alike = [name for name in unused if {_side(name), _side(marker)} != {"l", "r"}]
    text = f"marker {marker!r}{on}: not in the recording{did_you_mean(marker, alike)}"
    return Note("missing_marker", text, columns=(marker,))


def _side(marker: str) -> str:
    """Return on which side a marker is by its name, l or r; empty where that does not say."""
    found = re.match(r"(l|r|left|right)[ _.]|.*[ _.](l|r|left|right)$", marker.lower())
    return (found[1] or found[2])[0] if found else ""


def _unused(marker_set: MarkerSet, unused: Sequence[str]) -> list[Note]:
    if not unused:
        return []
    text = f"no segment of marker set {marker_set.name} uses {', '.join(unused)}"
    return [Note("unused_marker", text, columns=tuple(unused))]


def _too_few(marker_set: MarkerSet, segments: dict[str, tuple[str, ...]]) -> list[Note]:
    notes = []
    for segment, found in segments.items():
        listed = marker_set.segments[segment]
        if len(found) < _POSE <= len(listed):
            text = f"{segment} has {len(found)} of its {len(listed)} markers, expected three for a pose of its own"
            notes.append(Note("too_few_markers", text, columns=listed))
    return notes
