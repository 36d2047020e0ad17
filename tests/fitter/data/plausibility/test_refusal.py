"""A refusal is a mistake of data, told in one sentence, that its catchers can tell from others."""

import pytest

from fitter.data.plausibility.refusal import Refusal
from limbcal.errors import DataError


def test_a_refusal_is_a_mistake_of_the_data() -> None:
    with pytest.raises(DataError, match="expected degrees") as caught:
        raise Refusal("q1 spans 340, expected degrees: state --angle-unit deg")
    assert caught.value.exit_code == 2 == DataError("other").exit_code
    assert not isinstance(DataError("other"), Refusal)
