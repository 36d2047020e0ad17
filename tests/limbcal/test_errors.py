"""The error family."""

import pytest

from limbcal import errors
from limbcal.errors import ConfigError, LimbcalError


def test_the_whole_family_can_be_caught_at_once():
    members = [
        value
        for value in vars(errors).values()
        if isinstance(value, type) and issubclass(value, Exception) and value is not LimbcalError
    ]
    assert all(issubclass(member, LimbcalError) for member in members)
    assert {member.__name__: member.exit_code for member in members} == {
        "ConfigError": 2,
        "DataError": 2,
        "ProtocolError": 2,
        "DeviceError": 3,
        "NotIdentifiable": 4,
        "NotConverged": 4,
        "Unusable": 4,
    }


@pytest.mark.parametrize(("given", "mistakes"), [("one", ["one"]), (["one", "two"], ["one", "two"])])
def test_a_config_error_lists_its_mistakes(given, mistakes):
    error = ConfigError(given)
    assert error.mistakes == mistakes
    assert str(error) == "\n".join(mistakes)
