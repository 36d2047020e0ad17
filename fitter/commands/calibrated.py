"""What a calibration from markers ends with, of one limb or of a whole person."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

from arm.body.limbs import Girdle
from arm.model import Arm, Body
from fitter.body.calibration import calibrate_body
from fitter.body.document import body_document
from fitter.body.written_body import calibrated_body
from fitter.functional.marker_set import MarkerSet
from fitter.limb.json_document import document
from fitter.limb.limb_calibration import calibrate
from fitter.limb.limb_search import Search
from fitter.limb.marker_errors import MarkerErrors, beyond_skin, scores_of
from fitter.limb.written_arm import calibrated_arm
from limbcal.command import Document
from limbcal.note import Note, of_source
from protocol.markers.recording import MarkerRecording

Recordings = Sequence[MarkerRecording]
OnProgress = Callable[[str, int], None]


@dataclass(frozen=True)
class Calibrated:
    """What a calibration ends with.

    Attributes
    ----------
    arm : Arm
    document : Document
        The command's, without notes and time.
    notes : sequence of Note
    write_page : callable
        Given a path, the command's document and all notes, writes the report.
    """

    arm: Arm
    document: Document
    notes: Sequence[Note]
    write_page: Callable[[Path, Document, Sequence[Note]], None]


def calibrated_limb(
    learn: Recordings,
    evaluate: Recordings,
    marker_set: MarkerSet,
    limb: tuple[str, Girdle],
    body: Body | None,
    seed: int,
    progress: OnProgress,
    search: Search | None = None,
) -> Calibrated:
    """Calibrate one limb: its preset, and from where on an arm begins; by a search where one is given."""

    def write_page(path: Path, answer: Document, notes: Sequence[Note]) -> None:
        from fitter.report.limb_page import write_limb_page

        write_limb_page(path, fit, answer, [*learn, *evaluate], notes)

    preset, girdle = limb
    fit = calibrate(learn, marker_set, preset, girdle, body, seed, progress=progress, search=search)
    scores = scores_of(fit, learn, evaluate, seed)
    notes = [*fit.notes, *_contradicting(fit.marker_names, scores, learn, evaluate)]
    return Calibrated(calibrated_arm(fit, body), document(fit, scores), notes, write_page)


def calibrated_person(
    learn: Recordings,
    evaluate: Recordings,
    marker_set: MarkerSet,
    body: Body | None,
    seed: int,
    progress: OnProgress,
) -> Calibrated:
    """Calibrate a whole person."""

    def write_page(path: Path, answer: Document, notes: Sequence[Note]) -> None:
        from fitter.report.body_page import write_body_page

        write_body_page(path, fit, answer, [*learn, *evaluate], notes)

    fit = calibrate_body(learn, marker_set, body, seed, progress=progress)
    scores = scores_of(fit, learn, evaluate, seed)
    notes = [*fit.notes, *_contradicting(fit.marker_names, scores, learn, evaluate)]
    return Calibrated(calibrated_body(fit, body), body_document(fit, scores), notes, write_page)


def _contradicting(
    names: Sequence[str], scores: Mapping[str, MarkerErrors], learn: Recordings, evaluate: Recordings
) -> list[Note]:
    """Return which markers no calibrated person follows, recording by recording."""
    return [
        note
        for role, recordings in (("learn", learn), ("evaluate", evaluate))
        for k, recording in enumerate(recordings)
        for note in of_source(
            beyond_skin(names, scores[role].distance_m[scores[role].trial == k]), Path(recording.path).name
        )
    ]
