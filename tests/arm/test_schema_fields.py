"""Which fields a table of a file may have."""

import pytest

from arm.arm_file import format_arm, load_arm, parse_arm
from arm.arm_schema import ArmTable
from arm.schema_fields import fields_at
from limbcal.errors import ConfigError


@pytest.mark.parametrize(
    ("path", "fields"),
    [
        ([], {"schema", "name", "gravity_m_s2", "joint", "sensor", "control"}),
        (["joint", 1], {"a_m", "alpha_rad", "friction", "link"}),
        (["joint", 0, "friction"], {"viscous_N_m_s", "coulomb_N_m", "static_N_m"}),
        (["base_parameters", "I2"], {"value", "std"}),
        (["tip"], {"sensor", "offset_m"}),
    ],
)
def test_fields_are_those_of_the_table(path, fields):
    assert fields <= set(fields_at(ArmTable, path))


@pytest.mark.parametrize(
    ("line", "wrong", "meant"),
    [
        ("a_m = 0.25", "A_mm = 0.25", "joint[0].A_mm is not a known field; did you mean 'a_m'?"),
        ('law = "pd"', 'lwa = "pd"', "control.lwa is not a known field; did you mean 'law'?"),
        ("[control]", "[contrl]", "contrl is not a known field; did you mean 'control'?"),
        ("a_m = 0.25", "colour = 1", "joint[0].colour is not a known field"),
    ],
)
def test_a_mistyped_field_is_answered_with_what_was_meant(line, wrong, meant):
    text = format_arm(load_arm("dd-arm"))
    assert line in text
    with pytest.raises(ConfigError) as refused:
        parse_arm(text.replace(line, wrong, 1), "my.toml")
    assert f"my.toml: {meant}" in str(refused.value).splitlines()
