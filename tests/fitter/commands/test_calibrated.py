"""What a calibration from markers is made of, and what its report is given."""

from pathlib import Path
from types import SimpleNamespace

import pytest

from fitter.commands import calibrated
from fitter.commands.calibrated import calibrated_limb, calibrated_person
from fitter.report import body_page, limb_page

LEARN, EVALUATE = ("learn 1", "learn 2"), ("evaluate",)
FIT = SimpleNamespace(notes=("a note",))


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
    assert asked["document"] == (FIT, LEARN, EVALUATE, 7) and asked["calibrated_arm"] == (FIT, "body")
    assert (found.arm, found.document, found.notes) == ("an arm", {"of": "a limb"}, ("a note",))
    found.write_page(Path("page.html"), {"a": 1}, ["all notes"])
    assert asked["write_limb_page"] == (Path("page.html"), FIT, {"a": 1}, [*LEARN, *EVALUATE], ["all notes"])


def test_a_person_is_fitted_to_what_it_learns_from(asked) -> None:
    found = calibrated_person(LEARN, EVALUATE, "set", "body", 7, print)
    assert asked["calibrate_body"] == (LEARN, "set", "body", 7, ("progress", print))
    assert asked["body_document"] == (FIT, LEARN, EVALUATE, 7) and asked["calibrated_body"] == (FIT, "body")
    assert (found.arm, found.document, found.notes) == ("a person", {"of": "a person"}, ("a note",))
    found.write_page(Path("page.html"), {"a": 1}, [])
    assert asked["write_body_page"] == (Path("page.html"), FIT, {"a": 1}, [*LEARN, *EVALUATE], [])
