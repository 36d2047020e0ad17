"""Units as people write them."""

import math

import pytest
from hypothesis import given
from hypothesis import strategies as st

from protocol.tables.units import DIMENSIONS, is_no_unit, known_units, parse_unit, split_unit

KNOWN = "rad mrad deg rev m cm mm s ms us ns rad/s deg/s rev/s rpm m/s mm/s rad/s2 deg/s2 m/s2 mm/s2 g mg".split()
KNOWN += "dm um N.m N.mm N.cm mN.m kN.m N mN kN".split()


@pytest.mark.parametrize(
    ("text", "name", "factor"),
    [
        ("°", "deg", math.pi / 180.0),
        ("[°/s]", "deg/s", math.pi / 180.0),
        ("(deg / s)", "deg/s", math.pi / 180.0),
        ("deg/sec", "deg/s", math.pi / 180.0),
        ("°/s²", "deg/s2", math.pi / 180.0),
        ("Degrees", "deg", math.pi / 180.0),
        ("RAD", "rad", 1.0),
        ("rpm", "rpm", math.pi / 30.0),
        ("µs", "us", 1e-6),
        ("μs", "us", 1e-6),
        ("MS", "ms", 1e-3),
        ("Nm", "N.m", 1.0),
        ("N·m", "N.m", 1.0),
        ("N*m", "N.m", 1.0),
        ("N m", "N.m", 1.0),
        ("N-m", "N.m", 1.0),
        ("Nmm", "N.mm", 1e-3),
        ("mNm", "mN.m", 1e-3),
        ("m/s^2", "m/s2", 1.0),
        ("m/s**2", "m/s2", 1.0),
        ("m/s²", "m/s2", 1.0),
        ("m·s⁻²", "m/s2", 1.0),
        ("m s^-2", "m/s2", 1.0),
        ("g", "g", 9.80665),
        ("mm", "mm", 1e-3),
    ],
)
def test_usual_spellings(text, name, factor):
    unit = parse_unit(text)
    assert unit.name == name and unit.factor == pytest.approx(factor)


@pytest.mark.parametrize("text", ["", "grad", "NM", "M", "counts", "1", "kg", "V", "measured", "G"])
def test_what_is_no_unit_is_not_guessed(text):
    assert parse_unit(text) is None


@given(st.sampled_from(KNOWN), st.sampled_from(["{} [{}]", "{}[{}]", "{} ({})", "{}_({})", "{} / {}", "{} in {}"]))
def test_a_unit_is_parted_from_the_name_it_stands_in(unit, form):
    bare, found, certain = split_unit(form.format("q1", unit))
    assert (bare, found.name, certain) == ("q1", unit, True)


@given(st.sampled_from(KNOWN))
def test_a_unit_may_end_a_name(unit):
    for written in {unit, unit.replace("/", "_").replace(".", "_")}:
        bare, found, certain = split_unit(f"tau1_{written}")
        assert (bare, found.name) == ("tau1", unit) and certain == (len(written) > 1)


@pytest.mark.parametrize(
    "name", ["q1", "pos_meas1", "q[1]", "/joint_states/position[0]", "tau1 (measured)", "_deg"]
)
def test_names_without_a_unit_stay_whole(name):
    assert split_unit(name) == (name, None, False)


def test_every_role_has_units_of_its_own_dimensions():
    for dimensions in DIMENSIONS.values():
        assert known_units(dimensions)
    assert known_units(["time"]) == "s, ms, us, ns"
    assert is_no_unit("[-]") and is_no_unit(" ") and not is_no_unit("rad")


PI, G0 = 3.141592653589793, 9.80665
SAME = {
    **dict.fromkeys(("rad", "radian", "radians", "m", "metre", "meters", "s", "sec", "seconds"), 1.0),
    **dict.fromkeys(("rad/s", "m/s", "rad/s2", "rad/s/s", "m/s2", "m/s/s", "ms-2", "m.s-2"), 1.0),
    **dict.fromkeys(("N.m", "Nm", "N-m", "N", "newton"), 1.0),
    **dict.fromkeys(("mrad", "mm", "millimetres", "ms", "msec", "millisecond", "mm/s", "mm/s2"), 0.001),
    **dict.fromkeys(("N.mm", "Nmm", "N-mm", "mN.m", "mNm", "mN"), 0.001),
    **dict.fromkeys(("kN.m", "kNm", "kN"), 1000.0),
    **dict.fromkeys(("cm", "centimeters", "N.cm", "Ncm"), 0.01),
    **dict.fromkeys(("us", "usec", "microseconds", "um", "microns"), 0.000001),
    **dict.fromkeys(("dm", "decimetre"), 0.1),
    **dict.fromkeys(("in", "inch", "Inches"), 0.0254),
    **dict.fromkeys(("ft", "foot", "feet"), 0.3048),
    **dict.fromkeys(("ns", "nsec", "nanoseconds"), 0.000000001),
    **dict.fromkeys(("deg", "degree", "degrees", "deg/s", "dps", "deg/s2", "deg/s/s"), PI / 180.0),
    **dict.fromkeys(("rev", "turn", "turns", "rev/s"), 2.0 * PI),
    **dict.fromkeys(("rpm", "rev/min", "1/min"), PI / 30.0),
    **dict.fromkeys(("g", "g0"), G0),
    "mg": 0.00980665,
}


@pytest.mark.parametrize("text", SAME)
def test_a_unit_is_so_much_in_si(text):
    assert parse_unit(text).factor == pytest.approx(SAME[text], rel=1e-12)


@pytest.mark.parametrize(
    ("name", "bare", "unit", "certain"),
    [
        ("q1_deg", "q1", "deg", True),
        ("dq1_rad_s", "dq1", "rad/s", True),
        ("tau1_N_m", "tau1", "N.m", True),
        ("x_m", "x", "m", False),
        ("a_b_mm", "a_b", "mm", True),
        ("q_1 [deg]", "q_1", "deg", True),
        ("m", "m", None, False),
        ("[deg]", "[deg]", None, False),
        ("_deg", "_deg", None, False),
        ("angle", "angle", None, False),
        ("tau_in", "tau_in", None, False),
        ("tau_ft", "tau_ft", None, False),
        ("tip [in]", "tip", "in", True),
        ("speed (V)", "speed (V)", None, False),
    ],
)
def test_what_stands_behind_a_name_is_its_unit(name, bare, unit, certain):
    found = split_unit(name)
    assert (found[0], found[1] and found[1].name, found[2]) == (bare, unit, certain)


@pytest.mark.parametrize("text", ["", " ", "-", "–", "[-]", "None", "(n/a)"])
def test_a_cell_may_say_that_there_is_no_unit(text):
    assert is_no_unit(text)
    assert not is_no_unit(text + "s")
