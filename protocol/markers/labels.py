"""What labels say: prefixes, what is no marker but computed, and what stands there twice."""

import re
from collections import Counter

import numpy as np

from limbcal.note import Note
from protocol.markers.recording import RawRecording

#: How programs of motion laboratories name what they compute.
_COMPUTED = re.compile(r"(Angles?|Forces?|Moments?|Powers?|GRF|GRM|CentreOfMass|CentreOfMassFloor)$")
#: Two markers nearer than this are one [m]: a marker's own radius is larger.
_ONE_M = 1e-3
#: Markers are held against each other in as many frames at the most.
_FRAMES = 200


def without_prefix(label: str) -> str:
    """Return a label without the subject's name before it."""
    return label.rpartition(":")[2].strip()


def names_of(labels: tuple[str, ...]) -> tuple[str, ...]:
    """Return the names of markers: labels without prefix, but with it where it alone distinguishes two markers."""
    count = Counter(map(without_prefix, labels))
    return tuple(without_prefix(label) if count[without_prefix(label)] == 1 else label for label in labels)


def prefixes(raw: RawRecording) -> list[Note]:
    """Say which labels have the name of a subject or an object before them."""
    found = [label for label in raw.labels if ":" in label]
    if not found:
        return []
    kinds = len({label.rpartition(":")[0] for label in found})
    names = tuple(name for name, label in zip(names_of(raw.labels), raw.labels, strict=True) if ":" in label)
    kept = " where names differ without it" if any(":" in name for name in names) else ""
    text = f"{len(found)} of {len(raw.labels)} labels have a prefix, of {kinds} kind{'s' * (kinds > 1)}: left out"
    return [Note("prefix", text + kept, columns=names)]


def unnamed(raw: RawRecording) -> list[Note]:
    """Say that points without a name stand beside the markers."""
    if not raw.unnamed:
        return []
    return [
        Note(
            "unnamed", f"up to {raw.unnamed} points of a frame have no name, and no column of their own: left out"
        )
    ]


def computed(raw: RawRecording) -> tuple[list[Note], list[bool]]:
    """Say which points are angles, forces, moments or powers, and for each label whether it is."""
    known = {without_prefix(label) for label in raw.computed}
    is_one = [
        without_prefix(label) in known or bool(_COMPUTED.search(without_prefix(label))) for label in raw.labels
    ]
    names = tuple(without_prefix(label) for label, one in zip(raw.labels, is_one, strict=True) if one)
    if not names:
        return [], is_one
    text = f"{len(names)} points are computed, such as {names[0]}, and no markers: left out"
    return [Note("computed", text, columns=names)], is_one


def doubled(names: tuple[str, ...], positions: np.ndarray) -> list[Note]:
    """Say which markers stand there twice: by their names, or at one place.

    Parameters
    ----------
    names : tuple of str
    positions : (n_frame, n_marker, 3) [m]
    """
    plain = [re.sub(r"[^a-z0-9]", "", name.lower()) for name in names]
    notes = []
    for key, count in Counter(plain).items():
        if count > 1 and key:
            alike = tuple(name for name, one in zip(names, plain, strict=True) if one == key)
            said = f"{count} markers are called {alike[0]}" if len(set(alike)) == 1 else f"{' and '.join(alike)}"
            notes.append(Note("doubled", f"{said}: names differ by case, dots or prefix at most", columns=alike))
    some = positions[:: max(1, len(positions) // _FRAMES)]
    apart = np.linalg.norm(some[:, :, None] - some[:, None], axis=3)
    both = np.sum(np.isfinite(apart), axis=0)
    near = np.sum(apart < _ONE_M, axis=0)
    for i, j in np.argwhere(np.triu((both > 0) & (2 * near > both), 1)):
        if plain[i] != plain[j]:
            text = f"{names[i]} and {names[j]} are at one place: one is a copy of the other"
            notes.append(Note("doubled", text, columns=(names[i], names[j])))
    return notes
