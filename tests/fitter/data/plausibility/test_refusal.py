"""A refusal is a mistake of data, in one sentence, of a type that can be caught by itself."""

import pytest

from fitter.data.plausibility.refusal import Refusal
from limbcal.errors import DataError


def test_a_refusal_is_a_mistake_of_the_data() -> None:
    with pytest.raises(DataError, match="expected degrees") as caught:
        raise Refusal("q1 spans 340, expected degrees: state --angle-unit deg")
    assert caught.value.exit_code == 2 == DataError("other").exit_code
    assert not isinstance(DataError("other"), Refusal)
