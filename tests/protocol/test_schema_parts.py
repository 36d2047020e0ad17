"""Parts of the messages' schemas, by which what is written is what is described."""

import numpy as np
import pytest

from protocol.message import RAW, decode, encode
from protocol.schema_parts import array, by_name, one


def test_a_value_has_a_type_and_says_its_unit() -> None:
    assert one("number", "how long", "s") == {"type": "number", "description": "how long [s]"}
    assert one("string", "what it is called") == {"type": "string", "description": "what it is called"}


def test_an_array_says_its_shape_and_how_it_crosses_the_wire() -> None:
    schema = array("angles", "(n, n_joint)", "rad")
    assert schema["description"] == "angles, shape (n, n_joint) [rad]" and schema["type"] == "object"
    assert schema["required"] == ["dtype", "shape", "data"] == list(schema["properties"])
    for code in schema["properties"]["dtype"]["enum"]:
        assert np.dtype(code).str == code  # as numpy writes it, on a machine of any byte order
    assert schema["properties"]["shape"]["items"] == {"type": "integer"}
    assert schema["properties"]["data"]["contentEncoding"] == "binary"


@pytest.mark.parametrize("code", array("", "")["properties"]["dtype"]["enum"])
def test_every_element_type_that_is_told_crosses_the_wire(code: str) -> None:
    sent = np.array([[0, 1], [1, 1]]).astype(code)
    _, fields = decode(encode(RAW, {"a": sent}))
    assert fields["a"].dtype.str == code
    np.testing.assert_array_equal(fields["a"], sent)


def test_a_map_has_values_of_one_kind() -> None:
    value = one("number", "one of them")
    assert by_name("sizes", value) == {"type": "object", "description": "sizes", "additionalProperties": value}
