"""What a calibration from markers is made of, and what its report is given."""

from collections.abc import Sequence
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest

from fitter.commands import calibrated
from fitter.commands.calibrated import calibrated_limb, calibrated_person
from fitter.limb.marker_errors import MarkerErrors
from fitter.report import body_page, limb_page
from limbcal.note import Note

LEARN = (SimpleNamespace(path="some/learn 1"), SimpleNamespace(path="some/learn 2"))
EVALUATE = (SimpleNamespace(path="some/evaluate"),)
NOTE = Note("gap", "a note")
#: By how much markers "near" and "far" are off in a frame of each recording [m].
OFF_M = {"some/learn 1": (0.003, 0.01), "some/learn 2": (0.004, 0.09), "some/evaluate": (0.002, 0.02)}


def off(recordings: Sequence[SimpleNamespace], _seed: int) -> MarkerErrors:
    distance = np.array([OFF_M[one.path] for one in recordings])
    return MarkerErrors(distance, distance, np.arange(len(recordings)))


FIT = SimpleNamespace(notes=(NOTE,), marker_names=("near", "far"), marker_errors=off)


def check_scores(given: tuple[object, ...]) -> None:
    """Check that a document is given the fit, and the errors of both kinds of recordings apart."""
    fit, scores = given
    assert fit is FIT and isinstance(scores, dict) and [*scores] == ["learn", "evaluate"]
    assert [len(scores[role].distance_m) for role in scores] == [len(LEARN), len(EVALUATE)]


def check_notes(notes: Sequence[Note]) -> None:
    """Check that the marker that skin cannot take so far is named, with its recording, after the fit's notes."""
    first, far = notes
    assert first == NOTE and (far.kind, far.source, far.columns) == ("beyond_skin", "learn 2", ("far",))


@pytest.fixture
def asked(monkeypatch: pytest.MonkeyPatch) -> dict[str, tuple[object, ...]]:
    """Put words into the mouths of all that fits and writes; return what each was asked."""
    heard: dict[str, tuple[object, ...]] = {}
    answers = {
        "calibrate": FIT,
        "calibrate_body": FIT,
        "calibrated_arm": "an arm",
        "calibrated_body": "a person",
        "document": {"of": "a limb"},
        "body_document": {"of": "a person"},
        "write_limb_page": None,
        "write_body_page": None,
    }
    for name, answer in answers.items():

        def tell(*given: object, name: str = name, answer: object = answer, **more: object) -> object:
            heard[name] = (*given, *more.items())
            return answer

        written = {"write_limb_page": limb_page, "write_body_page": body_page}
        monkeypatch.setattr(written.get(name, calibrated), name, tell)
    return heard


@pytest.mark.parametrize("search", [None, "a search"])
def test_a_limb_is_fitted_to_what_it_learns_from(asked, search: str | None) -> None:
    limb = ("human-arm-left", "thorax")
    found = calibrated_limb(LEARN, EVALUATE, "set", limb, "body", 7, print, search)
    assert asked["calibrate"] == (LEARN, "set", *limb, "body", 7, ("progress", print), ("search", search))
    check_scores(asked["document"])
    assert asked["calibrated_arm"] == (FIT, "body")
    assert (found.arm, found.document) == ("an arm", {"of": "a limb"})
    check_notes(found.notes)
    found.write_page(Path("page.html"), {"a": 1}, ["all notes"])
    assert asked["write_limb_page"] == (Path("page.html"), FIT, {"a": 1}, [*LEARN, *EVALUATE], ["all notes"])


def test_a_person_is_fitted_to_what_it_learns_from(asked) -> None:
    found = calibrated_person(LEARN, EVALUATE, "set", "body", 7, print)
    assert asked["calibrate_body"] == (LEARN, "set", "body", 7, ("progress", print))
    check_scores(asked["body_document"])
    assert asked["calibrated_body"] == (FIT, "body")
    assert (found.arm, found.document) == ("a person", {"of": "a person"})
    check_notes(found.notes)
    found.write_page(Path("page.html"), {"a": 1}, [])
    assert asked["write_body_page"] == (Path("page.html"), FIT, {"a": 1}, [*LEARN, *EVALUATE], [])
