"""A marker set: which markers ride on which segment, and which of them are bony landmarks; read from TOML."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from importlib import resources
from pathlib import Path

from arm.body.tracked_segments import TRACKED_SEGMENTS
from fitter.functional.anatomy import LANDMARKS
from limbcal.errors import ConfigError
from limbcal.suggestion import did_you_mean
from limbcal.toml import parse_toml, read_toml_text

_BUILT_IN = resources.files("fitter.functional") / "marker_sets"
_FIELDS = ("schema", "name", "segments", "landmarks", "probe")
_SCHEMA = 1


@dataclass(frozen=True)
class MarkerSet:
    """Which markers ride on which segment.

    Attributes
    ----------
    name : str
    segments : mapping of str to tuple of str
        Markers of each segment; a marker is on one segment only.
    landmarks : mapping of str to str
        The marker of each bony landmark.
    probe : mapping of str to tuple of float
        Markers of a pointer, and where each is when its tip is at the origin [m].
    computed : frozenset of str
        Landmarks that are no measurement of their own, such as probed ones that their segment carries.
    """

    name: str
    segments: Mapping[str, tuple[str, ...]]
    landmarks: Mapping[str, str]
    probe: Mapping[str, tuple[float, float, float]] = field(default_factory=dict)
    computed: frozenset[str] = frozenset()

    @property
    def markers(self) -> tuple[str, ...]:
        """All markers of the set, each once, in the order of the file."""
        on_segments = [marker for markers in self.segments.values() for marker in markers]
        return tuple(dict.fromkeys([*on_segments, *self.landmarks.values()]))

    def segment_of(self, marker: str) -> str | None:
        """Return the segment that a marker rides on, or that its landmark is part of; None if there is none."""
        for segment, markers in self.segments.items():
            if marker in markers:
                return segment
        return next((LANDMARKS[name] for name, one in self.landmarks.items() if one == marker), None)


def marker_set_names() -> list[str]:
    """Return the names of the built-in marker sets."""
    return sorted(
        entry.name.removesuffix(".toml") for entry in _BUILT_IN.iterdir() if entry.name.endswith(".toml")
    )


def load_marker_set(source: str | Path) -> MarkerSet:
    """Read a marker set by the name of a built-in one or from a file.

    Raises
    ------
    ConfigError
        If there is no such set, or with every mistake that its file makes.
    """
    names = marker_set_names()
    if str(source) in names:
        return parse_marker_set((_BUILT_IN / f"{source}.toml").read_text(encoding="utf-8"), f"{source}.toml")
    try:
        text = read_toml_text(Path(source))
    except OSError as error:
        known = ", ".join(names) + did_you_mean(str(source), names)
        expected = f"expected a marker-set file or one of {known}"
        raise ConfigError(f"marker set {str(source)!r}: {error.strerror}; {expected}") from error
    return parse_marker_set(text, str(source))


def parse_marker_set(text: str, where: str) -> MarkerSet:
    """Read a marker set from the text of its file; ``where`` names the file in what is said of mistakes.

    Raises
    ------
    ConfigError
        With every mistake in the text.
    """
    raw = parse_toml(text, where)
    mistakes = [
        f"{where}: {key}: not a field of a marker set, expected {', '.join(_FIELDS)}{did_you_mean(key, _FIELDS)}"
        for key in raw
        if key not in _FIELDS
    ]
    if type(raw.get("schema")) is not int or raw["schema"] != _SCHEMA:
        mistakes.append(f"{where}: schema: found {_found(raw.get('schema'))}, expected {_SCHEMA}")
    if not (isinstance(raw.get("name"), str) and raw["name"].strip()):
        mistakes.append(f"{where}: name: found {_found(raw.get('name'))}, expected a name in quotes")
    segments = _segments(raw.get("segments"), where, mistakes)
    landmarks = _landmarks(raw.get("landmarks", {}), where, segments, mistakes)
    probe = _probe(raw.get("probe", {}), where, mistakes)
    if mistakes:
        raise ConfigError(mistakes)
    return MarkerSet(raw["name"], segments, landmarks, probe)


def _segments(raw: object, where: str, mistakes: list[str]) -> dict[str, tuple[str, ...]]:
    if not isinstance(raw, dict) or not raw:
        mistakes.append(
            f"{where}: segments: found {_found(raw)}, expected a table [segments] with at least one segment"
        )
        return {}
    found: dict[str, tuple[str, ...]] = {}
    rides_on: dict[str, str] = {}
    for segment, markers in raw.items():
        if segment not in TRACKED_SEGMENTS:
            known = f"{', '.join(TRACKED_SEGMENTS)}{did_you_mean(segment, TRACKED_SEGMENTS)}"
            mistakes.append(f"{where}: segments.{segment}: no such segment, expected {known}")
        if not isinstance(markers, list) or not markers or not all(map(_is_name, markers)):
            expected = 'expected a list of marker names, such as ["A1", "A2", "A3"]'
            mistakes.append(f"{where}: segments.{segment}: found {_found(markers)}, {expected}")
            continue
        for marker in markers:
            if marker in rides_on:
                twice = f"{marker!r} is on {rides_on[marker]} too, expected each marker once"
                mistakes.append(f"{where}: segments.{segment}: {twice}")
            rides_on.setdefault(marker, segment)
        found[segment] = tuple(markers)
    return found


def _landmarks(
    raw: object, where: str, segments: Mapping[str, tuple[str, ...]], mistakes: list[str]
) -> dict[str, str]:
    if not isinstance(raw, dict):
        mistakes.append(f"{where}: landmarks: found {_found(raw)}, expected a table [landmarks]")
        return {}
    rides_on = {marker: segment for segment, markers in segments.items() for marker in markers}
    found: dict[str, str] = {}
    of_marker: dict[str, str] = {}
    for landmark, marker in raw.items():
        if landmark not in LANDMARKS:
            meant = did_you_mean(landmark, LANDMARKS) or f", expected one of {', '.join(LANDMARKS)}"
            mistakes.append(f"{where}: landmarks.{landmark}: no such landmark{meant}")
            continue
        if not _is_name(marker):
            mistakes.append(f"{where}: landmarks.{landmark}: found {_found(marker)}, expected a marker's name")
            continue
        if marker in of_marker:
            other = of_marker[marker]
            mistakes.append(f"{where}: landmarks.{landmark}: {marker!r} is {other} too, expected each marker once")
        if rides_on.get(marker, LANDMARKS[landmark]) != LANDMARKS[landmark]:
            where_it_is = f"{marker!r} is on {rides_on[marker]}, expected it on {LANDMARKS[landmark]}"
            mistakes.append(f"{where}: landmarks.{landmark}: {where_it_is}")
        of_marker.setdefault(marker, landmark)
        found[landmark] = marker
    return found


def _probe(raw: object, where: str, mistakes: list[str]) -> dict[str, tuple[float, float, float]]:
    if not isinstance(raw, dict):
        mistakes.append(f"{where}: probe: found {_found(raw)}, expected a table [probe]")
        return {}
    found: dict[str, tuple[float, float, float]] = {}
    for marker, place in raw.items():
        if isinstance(place, list) and len(place) == 3 and all(type(x) in (int, float) for x in place):
            found[marker] = (float(place[0]), float(place[1]), float(place[2]))
        else:
            mistakes.append(f"{where}: probe.{marker}: found {_found(place)}, expected [x, y, z] from the tip [m]")
    return found


def _is_name(value: object) -> bool:
    return isinstance(value, str) and bool(value.strip())


def _found(value: object) -> str:
    return "nothing" if value is None else f"{str(value)[:60]!r}"
