"""Damaged copies of measured recordings of markers: how often `fitter markers` names what was done to them.

    python -m benchmarks.damaged_markers DATA --copies 40 --seed 0

DATA is the folder with the recordings. Each copy is one recording with one damage, of a kind, a size, a place and
markers that the seed draws. A damage is found if a note has its kind and its markers, and overlaps it in time.
Recordings as they are must have no exchanged labels.
"""

import argparse
import sys
from collections.abc import Callable, Sequence
from dataclasses import asdict, dataclass, replace
from pathlib import Path

import numpy as np

from limbcal.arguments import Parser, common_options
from limbcal.command import Document, emit, run_command, say
from limbcal.errors import ConfigError
from limbcal.note import Note
from protocol.markers.marker_files import look_at, read_raw
from protocol.markers.recording import RawRecording

Rng = np.random.Generator
#: Recordings of each person that are damaged, by folder.
FILES = {
    "kineticstoolkit": ("racing_full.c3d", "sample_static.c3d", "sample_propulsion.c3d"),
    "biobuddy": ("static.c3d", "right_knee.c3d", "anat_pose_ECH.c3d"),
    "btk": ("FunctionalLHip.c3d", "FunctionalStatic.c3d"),
    "opencap_subject4/MarkerData": ("squats1.trc", "static1.trc", "DJ1.trc"),
}


@dataclass(frozen=True)
class Damage:
    """What was done."""

    kind: str
    markers: tuple[str, ...] = ()
    from_s: float | None = None
    to_s: float | None = None


def measure(options: argparse.Namespace) -> Document:
    """Damage copies, look through them, and say what was named."""
    persons = {
        folder: [
            read_raw(options.data / folder / name) for name in names if (options.data / folder / name).exists()
        ]
        for folder, names in FILES.items()
    }
    people = [raws for raws in persons.values() if raws]
    if not people:
        raise ConfigError(f"{options.data}: none of the recordings is there, expected some of {', '.join(FILES)}")
    clean = sum(note.kind == "swapped" for raws in people for one in look_at(raws) for note in one.notes)
    rng, kinds, copies = np.random.default_rng(options.seed), list(DAMAGES), list[Document]()
    for k in range(options.copies):
        raws = people[int(rng.integers(len(people)))]
        which = int(rng.integers(len(raws)))
        # What cannot be done to a recording is replaced by an exchange of labels.
        copy, damage = DAMAGES[kinds[k % len(kinds)]](rng, raws[which]) or _swapped(rng, raws[which])
        notes = look_at([copy if i == which else raw for i, raw in enumerate(raws)])[which].notes
        named = any(_names(note, damage) for note in notes)
        where = "" if damage.from_s is None else f" {damage.from_s:.2f}-{damage.to_s:.2f} s"
        say(f"{'found ' if named else 'MISSED'} {damage.kind} {Path(copy.path).name} {damage.markers}{where}")
        copies.append({"file": Path(copy.path).name, **asdict(damage), "named": named})
    found = sum(bool(one["named"]) for one in copies)
    if not options.json:
        emit(f"{clean} exchanges claimed in {sum(map(len, people))} recordings as they are")
        emit(f"{found} of {options.copies} named")
    return {"claimed": clean, "copies": copies}


def main(argv: Sequence[str] | None = None) -> int:
    """Run the benchmark and return its exit code."""
    parser = Parser(prog="python -m benchmarks.damaged_markers", description=__doc__, parents=[common_options()])
    parser.add_argument("data", type=Path)
    parser.add_argument("--copies", type=int, default=40)
    parser.add_argument("--seed", type=int, default=0)
    parser.set_defaults(action=measure)
    return run_command(parser, argv)


def _names(note: Note, damage: Damage) -> bool:
    """Say whether a note has a damage's kind and its markers, and overlaps it in time."""
    if note.kind != damage.kind or not set(damage.markers) <= set(note.columns):
        return False
    return damage.from_s is None or note.from_s is None or _overlap(damage, note.from_s, note.to_s)


def _overlap(damage: Damage, from_s: float | None, to_s: float | None) -> bool:
    if from_s is None or to_s is None or damage.from_s is None or damage.to_s is None:
        return True
    return from_s <= damage.to_s + 0.05 and to_s >= damage.from_s - 0.05


def _seen(raw: RawRecording) -> list[int]:
    """Return markers that are seen in nine frames of ten, zeros aside."""
    known = np.isfinite(raw.points).all(axis=2) & raw.points.any(axis=2)
    return [k for k in np.flatnonzero(known.mean(axis=0) > 0.9) if raw.labels[k] not in raw.computed]


def _name(raw: RawRecording, k: int) -> str:
    return raw.labels[k].rpartition(":")[2]


def _interval(rng: Rng, raw: RawRecording, least_s: float) -> tuple[int, int]:
    n = len(raw.points)
    lasts = int(min(max(least_s * raw.rate_hz, rng.uniform(0.05, 0.3) * n), 0.4 * n))
    first = int(rng.integers(1, n - lasts))
    return first, first + lasts


def _swapped(rng: Rng, raw: RawRecording) -> tuple[RawRecording, Damage]:
    seen = _seen(raw)
    metres = 1e-3 if raw.unit == "mm" else 1.0
    middle = {k: np.nanmedian(raw.points[:, k], axis=0) * metres for k in seen}
    while True:  # two that are far enough apart for it to matter
        i, j = (int(k) for k in rng.choice(seen, 2, replace=False))
        if np.linalg.norm(middle[i] - middle[j]) > 0.06:
            break
    first, last = _interval(rng, raw, 0.5)
    points = raw.points.copy()
    points[first:last, [i, j]] = points[first:last, [j, i]]
    times = first / raw.rate_hz, last / raw.rate_hz
    return replace(raw, points=points), Damage("swapped", (_name(raw, i), _name(raw, j)), *times)


def _whole(rng: Rng, raw: RawRecording) -> tuple[RawRecording, Damage]:
    copy, damage = _swapped(rng, raw)
    names = [_name(raw, k) for k in range(len(raw.labels))]
    i, j = (names.index(name) for name in damage.markers)
    points = raw.points.copy()
    points[:, [i, j]] = points[:, [j, i]]
    return replace(raw, points=points), Damage("swapped", damage.markers)


def _unit(rng: Rng, raw: RawRecording) -> tuple[RawRecording, Damage]:
    return replace(raw, unit="m" if raw.unit == "mm" else "mm"), Damage("unit")


def _up(rng: Rng, raw: RawRecording) -> tuple[RawRecording, Damage] | None:
    return None if not raw.up else (replace(raw, up="+x"), Damage("up"))


def _zeros(rng: Rng, raw: RawRecording) -> tuple[RawRecording, Damage]:
    k, (first, last) = int(rng.choice(_seen(raw))), _interval(rng, raw, 0.2)
    points = raw.points.copy()
    points[first:last, k] = 0.0 if rng.random() < 0.5 else -16512.0
    return replace(raw, points=points), Damage("zeros", (_name(raw, k),), first / raw.rate_hz, last / raw.rate_hz)


def _gap(rng: Rng, raw: RawRecording) -> tuple[RawRecording, Damage]:
    k, (first, last) = int(rng.choice(_seen(raw))), _interval(rng, raw, 0.2)
    points = raw.points.copy()
    points[first:last, k] = np.nan
    return replace(raw, points=points), Damage("gap", (_name(raw, k),), first / raw.rate_hz, last / raw.rate_hz)


def _prefix(rng: Rng, raw: RawRecording) -> tuple[RawRecording, Damage]:
    labels = tuple(f"S{rng.integers(9)}:{label}" for label in raw.labels)
    return replace(raw, labels=labels), Damage("prefix", (_name(raw, 0),))


def _jump(rng: Rng, raw: RawRecording) -> tuple[RawRecording, Damage]:
    k, (first, last) = int(rng.choice(_seen(raw))), _interval(rng, raw, 0.1)
    leap = rng.normal(size=3)
    leap *= rng.uniform(0.08, 0.4) / np.linalg.norm(leap) * (1000.0 if raw.unit == "mm" else 1.0)
    points = raw.points.copy()
    points[first:last, k] += leap
    return replace(raw, points=points), Damage("jump", (_name(raw, k),), first / raw.rate_hz, last / raw.rate_hz)


def _doubled(rng: Rng, raw: RawRecording) -> tuple[RawRecording, Damage]:
    k = int(rng.choice(_seen(raw)))
    label = raw.labels[k] + "." if rng.random() < 0.5 else f"copy{k}"
    noise = 1e-5 * rng.normal(size=raw.points[:, [k]].shape) * (1000.0 if raw.unit == "mm" else 1.0)
    points = np.concatenate([raw.points, raw.points[:, [k]] + noise], axis=1)
    return replace(raw, labels=(*raw.labels, label), points=points), Damage("doubled", (_name(raw, k), label))


def _nan_forces(rng: Rng, raw: RawRecording) -> tuple[RawRecording, Damage] | None:
    if not raw.forces:
        return None
    record = raw.forces[0]
    channels = record.channels.copy()
    n = len(channels)
    last = int(rng.uniform(0.3, 1.0) * n)
    first = max(0, last - int(rng.uniform(0.15, 0.5) * record.rate_hz))
    channels[first:last] = np.nan
    forces = (replace(record, channels=channels), *raw.forces[1:])
    times = first / record.rate_hz, last / record.rate_hz
    return replace(raw, forces=forces), Damage("nan_forces", (record.name,), *times)


def _clock(rng: Rng, raw: RawRecording) -> tuple[RawRecording, Damage] | None:
    if raw.t is None and len(raw.other_rates) == 0:
        return None
    return replace(raw, rate_hz=raw.rate_hz * float(rng.choice([0.1, 0.5, 1.2, 2.0]))), Damage("clock")


def _computed(rng: Rng, raw: RawRecording) -> tuple[RawRecording, Damage]:
    angle = rng.normal(size=(len(raw.points), 1, 3)).cumsum(axis=0)
    points = np.concatenate([raw.points, angle], axis=1)
    label = str(rng.choice(["LKneeAngles", "RAnkleMoment", "LHipPower"]))
    return replace(raw, labels=(*raw.labels, label), points=points), Damage("computed", (label,))


DAMAGES: dict[str, Callable[[Rng, RawRecording], tuple[RawRecording, Damage] | None]] = {
    "swapped": _swapped,
    "whole": _whole,
    "unit": _unit,
    "up": _up,
    "zeros": _zeros,
    "gap": _gap,
    "prefix": _prefix,
    "jump": _jump,
    "doubled": _doubled,
    "nan_forces": _nan_forces,
    "clock": _clock,
    "computed": _computed,
}

if __name__ == "__main__":
    sys.exit(main())
