"""Notes: what programs and people read of them."""

from limbcal.note import Note, documents, of_source, sentences

TURN = Note("turn", "q1 leaps by a turn; unwrapped", columns=("q1",), row=7, from_s=0.6)


def test_the_document_holds_every_field_under_the_contract_s_names() -> None:
    assert TURN.document() == {
        "kind": "turn",
        "source": "",
        "columns": ["q1"],
        "markers": ["q1"],
        "row": 7,
        "from_s": 0.6,
        "to_s": None,
        "text": "q1 leaps by a turn; unwrapped",
    }


def test_a_source_is_filled_in_once() -> None:
    (noted,) = of_source([TURN], "a.csv")
    assert noted.sentence == "a.csv: q1 leaps by a turn; unwrapped"
    assert of_source([noted], "b.csv") == (noted,)


def test_the_same_note_is_listed_once() -> None:
    assert documents([TURN, TURN]) == [TURN.document()]


def test_a_sentence_that_several_sources_share_is_said_once_with_all_of_them() -> None:
    shared = [Note("turn", "unwrapped", source) for source in ("a", "b")]
    assert sentences([*shared, TURN]) == ["a, b: unwrapped", f"{TURN.text} (the first in row 7)"]
    three = [Note("turn", "unwrapped", source) for source in "abc"]
    assert sentences(three) == ["a, b, c: unwrapped"]
    assert sentences([*three, Note("turn", "unwrapped", "d")]) == ["a, b and 2 more: unwrapped"]
    rows = [Note("turn", "unwrapped", source, row=row) for source, row in (("a", 3), ("b", 4))]
    assert sentences(rows) == ["a, b: unwrapped"]  # each row stands in the document
    assert sentences([Note("lost", "row 3 has no time", "a", row=3)]) == ["a: row 3 has no time"]
    many = [Note("turn", "unwrapped", f"{k}") for k in range(22)]
    assert sentences(many) == ["0, 1 and 20 more: unwrapped"]
