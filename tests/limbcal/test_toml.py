"""TOML bombs are one sentence."""

from pathlib import Path

import pytest

from limbcal.errors import ConfigError
from limbcal.toml import MAX_BYTES, MAX_DEPTH, parse_toml, read_toml_text


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("a = " + "[" * 100_000, "nested too deep"),
        ("a = " + "{b = " * 100_000, "nested too deep"),
        ("a." * 3_000 + "b = 1", "nested too deep"),
        ("[" + "a." * MAX_DEPTH + "b]", f"nested too deep, expected at most {MAX_DEPTH} levels"),
        ("a = " + "1" * 6000, "an integer of too many digits"),
        ("a = 0x" + "f" * 6000, "an integer beyond 64 bits"),
        ("a = 9223372036854775808", "an integer beyond 64 bits"),
        ('a = "\0"', "Illegal character '\\x00'"),
        ('a = "x\\u0000"', "a NUL character in 'x\\x00', expected text"),
        ('"x\\u0000" = 1', "a NUL character in 'x\\x00', expected text"),
        ("#" * (MAX_BYTES + 1), f"expected at most {MAX_BYTES}"),
        ("a = 1\na = 2", "Cannot overwrite a value"),
    ],
)
def test_a_bomb_is_one_sentence(text: str, said: str) -> None:
    with pytest.raises(ConfigError) as refused:
        parse_toml(text, "arm.toml in x.mcap")
    assert str(refused.value).startswith("arm.toml in x.mcap: not TOML: ")
    assert said in str(refused.value)
    assert str(refused.value).isprintable() and len(str(refused.value)) < 200


def test_what_is_in_bounds_is_read() -> None:
    deep = "[" * (MAX_DEPTH - 2) + "]" * (MAX_DEPTH - 2)
    tables = parse_toml(f"a = {deep}\nb = 9223372036854775807\nc = -9223372036854775808", "x")
    assert (tables["b"], tables["c"]) == (2**63 - 1, -(2**63))


def test_a_file_without_end_or_without_text_is_one_sentence(tmp_path: Path) -> None:
    with pytest.raises(ConfigError, match="more than 8388608 bytes"):
        read_toml_text(Path("/dev/zero"))
    (tmp_path / "x.toml").write_bytes(b"\xff")
    with pytest.raises(ConfigError, match="expected UTF-8 text"):
        read_toml_text(tmp_path / "x.toml")


@pytest.mark.parametrize("depth", [MAX_DEPTH - 1, MAX_DEPTH])
@pytest.mark.parametrize("brackets", ["[]", "{}"])
def test_values_lie_sixteen_levels_deep_at_most(depth: int, brackets: str) -> None:
    """The document itself is the first, and a value the last."""
    if brackets == "[]":
        text = "a = " + "[" * (depth - 1) + "1" + "]" * (depth - 1)
    else:
        text = "a = " + "{b = " * (depth - 1) + "1" + "}" * (depth - 1)
    if depth < MAX_DEPTH:
        assert set(parse_toml(text, "x")) == {"a"}
    else:
        with pytest.raises(ConfigError, match="x: not TOML: nested too deep, expected at most 16 levels"):
            parse_toml(text, "x")


@pytest.mark.parametrize("value", [2**63, -(2**63) - 1, 2**64, -(2**64)])
def test_an_integer_has_64_bits_wherever_it_stands(value: int) -> None:
    for text in (f"a = {value}", f"a = [1, {value}]", f"a.b = {value}", f"[[c]]\nd = {{e = {value}}}"):
        with pytest.raises(ConfigError, match="an integer beyond 64 bits"):
            parse_toml(text, "x")


def test_eight_mebibytes_are_read_and_no_byte_more(tmp_path: Path) -> None:
    path = tmp_path / "x.toml"
    path.write_bytes(b"#" * 8 * 1024 * 1024)
    assert len(read_toml_text(path)) == MAX_BYTES == 2**23
    assert parse_toml("#" * MAX_BYTES, "x") == {}
    path.write_bytes(b"#" * (MAX_BYTES + 1))
    with pytest.raises(ConfigError, match="not TOML: more than 8388608 bytes"):
        read_toml_text(path)


def test_of_a_text_with_a_nul_twenty_characters_are_shown() -> None:
    with pytest.raises(ConfigError, match="a NUL character in '12345678901234567890', expected text"):
        parse_toml('a = "1234567890123456789012\\u0000"', "x")
