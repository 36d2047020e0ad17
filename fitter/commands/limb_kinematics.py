"""`fitter kinematics FUNCTIONAL… --body PRESET`: a person, or one arm or leg, from recordings of markers."""

import argparse
import time
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

from rich.markup import escape
from rich.progress import Progress
from rich.table import Table

from arm.arm_file import save_arm
from arm.body.limbs import BODY, LIMBS, Girdle
from arm.model import Body
from fitter.commands.calibrated import calibrated_limb, calibrated_person
from fitter.commands.limb_export import add_export, check_export, export
from fitter.commands.options import height_m, make_room, mass_kg
from fitter.functional.marker_set import load_marker_set
from fitter.kinematics.geometry_fit import LEAST_EXPLAINED
from fitter.limb.limb_search import GENERATIONS, Search
from fitter.limb.marker_errors import hardly
from fitter.limb.probing import with_probed
from limbcal.command import Document, console, say_notes, show
from limbcal.errors import ConfigError, Unusable
from limbcal.note import Note, documents, of_source
from protocol.markers.marker_files import read_markers
from protocol.markers.recording import MarkerRecording

#: Notes of a recording that a calibration passes on: the others are of `fitter markers`.
_PASSED_ON = ("swapped", "unit", "up", "clock", "doubled")
UPS = ("+x", "-x", "+y", "-y", "+z", "-z")
#: Options of the calibration from a measured tip, which mean nothing here.
_NOT_HERE: tuple[tuple[str, object], ...] = (
    ("arm", None), ("columns", None), ("rate_hz", None), ("bounds", None), ("fix", None), ("free", ""),
    ("about", "auto"), ("angle_noise_deg", "auto"), ("compare", []),
)  # fmt: skip
#: Options that mean nothing but here.
_ONLY_HERE = ("marker_set", "probe", "base", "up", "mass", "height", "sex", "export")
#: Options of the genetic algorithm.
_OF_THE_SEARCH: tuple[tuple[str, object], ...] = (("population", None), ("generations", GENERATIONS))


def add_body(parser: argparse.ArgumentParser) -> None:
    """Add what a person or a person's limb needs."""
    group = parser.add_argument_group("a person, or one arm or leg, from markers (C3D, TRC)")
    bodies = (BODY, *LIMBS)
    group.add_argument("--body", choices=bodies, metavar="PRESET", help=f"what of a person: {', '.join(bodies)}")
    group.add_argument("--marker-set", metavar="NAME|FILE", help="which markers ride on which segment")
    group.add_argument(
        "--probe",
        action="append",
        default=[],
        metavar="LANDMARK=FILE",
        help="a recording in which the marker set's pointer rests on a bony point, such as acromion_right=a.c3d",
    )
    group.add_argument("--base", choices=["scapula", "thorax"], help="from where on a single arm begins (scapula)")
    group.add_argument(
        "--up", choices=UPS, help="which axis of the laboratory points up (as header or stance have it)"
    )
    group.add_argument(
        "--method",
        choices=["bundle", "ga"],
        help="the bundle fit (default); or the genetic algorithm without starting values on the same objective, "
        "and how far it ends from the bundle fit",
    )
    group.add_argument("--mass", type=mass_kg, metavar="KG", help="with --height and --sex: the table's masses")
    group.add_argument("--height", type=height_m, metavar="M")
    group.add_argument("--sex", choices=["f", "m"])
    add_export(group, motions=False)


def limb_kinematics(arguments: argparse.Namespace) -> Document:
    """Learn a person or a limb and write it.

    Raises
    ------
    Unusable
        If next to nothing of the markers' motion is explained.
    """
    _require_options(arguments)
    body = body_of(arguments)
    marker_set = load_marker_set(arguments.marker_set)
    make_room(arguments.out, read=[*arguments.data, *arguments.evaluate])
    check_export(arguments.export, motions=False)
    if arguments.report is not None:
        make_room(arguments.report, (".html",))
    # Together: each recording of a person shows which labels of the others are right.
    recordings, notes = recordings_of([*arguments.data, *arguments.evaluate])
    if arguments.probe:
        probed = with_probed(recordings, _probings(arguments.probe), marker_set)
        recordings, marker_set, notes = list(probed.recordings), probed.marker_set, [*notes, *probed.notes]
    learn, evaluate = recordings[: len(arguments.data)], recordings[len(arguments.data) :]
    if arguments.up is not None:
        learn, evaluate = ([replace(one, up=arguments.up) for one in some] for some in (learn, evaluate))
    began = time.perf_counter()
    with Progress(console=console, transient=True) as bar:
        task = bar.add_task("fitting", total=None)

        def report(what: str, iteration: int) -> None:
            bar.update(task, description=f"{what}, iteration {iteration}")

        if arguments.body == BODY:
            found = calibrated_person(learn, evaluate, marker_set, body, arguments.seed, report)
        else:
            girdle: Girdle = "thorax" if arguments.base == "thorax" else "scapula"
            limb = (arguments.body, girdle)
            search = Search(arguments.population, arguments.generations) if arguments.method == "ga" else None
            found = calibrated_limb(learn, evaluate, marker_set, limb, body, arguments.seed, report, search)
    answer: dict[str, object] = {**found.document, "seconds": time.perf_counter() - began}
    notes = [*notes, *found.notes, *_no_masses(body)]
    save_arm(found.arm, arguments.out)
    say_notes(notes)
    _show(found.arm.name, answer)
    show(f"{found.arm.name} -> {arguments.out}")
    if arguments.report is not None:
        found.write_page(arguments.report, answer, notes)
        show(f"report: {arguments.report}")
    answer |= {"exported": export(arguments.export, found.arm), "notes": documents(notes)}
    explained = dict(answer["explained"])  # type: ignore[call-overload]
    reasons = [
        f"{title} trials: {hardly(explained[role])}"
        for role, title in (("learn", "learning"), ("evaluate", "evaluating"))
        if explained[role] is not None and explained[role] < LEAST_EXPLAINED
    ]
    if reasons:
        raise Unusable(reasons, answer)
    return answer


def _require_options(arguments: argparse.Namespace) -> None:
    mistakes = [
        f"--{name.replace('_', '-')} is given, expected it only without --body"
        for name, usual in _NOT_HERE
        if getattr(arguments, name) != usual
    ]
    if arguments.method != "ga":
        mistakes += [
            f"--{name} is given, expected it with --body only beside --method ga: the bundle fit has none"
            for name, usual in _OF_THE_SEARCH
            if getattr(arguments, name) != usual
        ]
    elif arguments.body == BODY:
        mistakes.append(f"--method ga is given with --body {BODY}, expected it with one limb: {', '.join(LIMBS)}")
    if arguments.base is not None and not arguments.body.startswith("human-arm"):
        mistakes.append(f"--base is given with --body {arguments.body}, expected it with a single arm")
    if arguments.marker_set is None:
        mistakes.append("--marker-set is missing, expected the name of a built-in marker set or a file")
    if mistakes:
        raise ConfigError(mistakes)


def require_no_limb(arguments: argparse.Namespace) -> None:
    """Refuse options of a person or limb where none is calibrated.

    Raises
    ------
    ConfigError
        With every one that is given.
    """
    given = [f"--{name.replace('_', '-')}" for name in _ONLY_HERE if getattr(arguments, name)]
    given += ["--method bundle"] if arguments.method == "bundle" else []
    if given:
        raise ConfigError([f"{name} is given, expected it only with --body" for name in given])


def body_of(arguments: argparse.Namespace) -> Body | None:
    """Return whose limb it is, as far as that is said.

    Raises
    ------
    ConfigError
        If only some of mass, height and sex are given.
    """
    given = [arguments.mass, arguments.height, arguments.sex]
    if all(value is None for value in given):
        return None
    if any(value is None for value in given):
        names = [n for n, value in zip(("--mass", "--height", "--sex"), given, strict=True) if value is None]
        raise ConfigError(f"{' and '.join(names)} missing, expected --mass, --height and --sex together")
    return Body(arguments.body, arguments.mass, arguments.height, arguments.sex)


def _probings(texts: Sequence[str]) -> dict[str, MarkerRecording]:
    """Read the recordings of probed points, by landmark."""
    pairs = [text.partition("=") for text in texts]
    wrong = [text for text, (_, _, path) in zip(texts, pairs, strict=True) if not path]
    if wrong:
        raise ConfigError(f"--probe {wrong[0]!r}: expected LANDMARK=FILE, such as acromion_right=probing.c3d")
    looked = read_markers([Path(path) for _, _, path in pairs])
    return {landmark: one.recording for (landmark, _, _), one in zip(pairs, looked, strict=True)}


def recordings_of(paths: Sequence[Path]) -> tuple[list[MarkerRecording], list[Note]]:
    """Read recordings of markers with a bar, and return what is to be said of each."""
    with Progress(console=console, transient=True) as bar:
        task = bar.add_task("reading trials", total=len(paths))
        looked = read_markers(list(paths), lambda done: bar.update(task, completed=done))
    notes = [
        note
        for one in looked
        for note in of_source([n for n in one.notes if n.kind in _PASSED_ON], Path(one.recording.path).name)
    ]
    return [one.recording for one in looked], notes


def _no_masses(body: Body | None) -> list[Note]:
    if body is not None:
        return []
    text = "without --mass, --height and --sex the links have no masses; expected them for `fitter torque`"
    return [Note("no_masses", text)]


def _show(whose: str, answer: Document) -> None:
    table = Table(title=escape(f"{whose}: {answer['samples']} frames"), title_justify="left")
    for column in ("", "value", "95 %", "disjoint trials apart"):
        table.add_column(column)
    lengths, centres, axes = (dict(answer[k]) for k in ("lengths_m", "centres", "axes"))  # type: ignore[call-overload]
    for name, one in lengths.items():
        half = one["ci95"][1] - one["value"]
        table.add_row(escape(f"length {name} [mm]"), f"{1e3 * one['value']:.0f}", f"± {1e3 * half:.0f}", "")
    for name, one in centres.items():
        apart = _number(one["apart_mm"], ".1f")
        table.add_row(escape(f"centre {name} [mm]"), "", f"sd {one['std_mm']:.1f}", apart)
    for name, one in axes.items():
        std, apart = _number(one["std_deg"], ".1f") or "?", _number(one["apart_deg"], ".1f")
        table.add_row(escape(f"axis {name} [°]"), "", f"sd {std}", apart)
    show(table)
    for line in method_lines(answer):
        show(line)
    for role in ("learn", "evaluate"):
        rms = dict(answer["marker_rms_mm"]).get(role)  # type: ignore[call-overload]
        if rms is not None:
            show(
                f"{role}: markers off by {rms['rms']:.1f} mm rms, {rms['median']:.1f} median, {rms['max']:.0f} "
                f"at the most, in {rms['frames']} frames"
            )


def method_lines(answer: Document) -> list[str]:
    """Return a line for the bundle fit, the genetic algorithm and both in turn; none where only one was done."""
    what = {
        "bundle": "bundle fit, from landmarks and functional centres",
        "ga": "genetic algorithm alone (this answer), without starting values",
        "ga+bundle": "bundle fit from where that ended",
    }
    compared = dict(answer.get("compared", {}))  # type: ignore[call-overload]
    return [
        f"{text}: markers off by {one['marker_rms_mm']:.2f} mm rms; from the bundle fit markers "
        f"{one['apart_mm']:.1f}, centres {one['centres_apart_mm']:.1f} mm, cost {one['cost']:+.1f}; "
        f"{one['cpu_s']:.1f} s of processor time"
        for text, one in ((text, compared[name]) for name, text in what.items() if name in compared)
    ]


def _number(value: float | None, form: str) -> str:
    return "" if value is None else format(value, form)
