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
        ("a." * 30_000 + "b = 1", "nested too deep"),
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
