"""Text and numbers of marker and force tables."""

import pytest

from protocol.markers.text_table import number_of, text_of


@pytest.mark.parametrize("encoding", ["utf-8", "utf-8-sig", "utf-16", "cp1252"])
def test_text_is_read_in_its_own_encoding(tmp_path, encoding):
    path = tmp_path / "some.trc"
    path.write_text("Kniegelenk außen\t1,5\n" * 5, encoding)
    assert text_of(path) == "Kniegelenk außen\t1,5\n" * 5


def test_a_number_has_a_point_or_a_comma():
    assert (number_of("1.5"), number_of("1,5"), number_of("-2"), number_of("1e-3")) == (1.5, 1.5, -2.0, 1e-3)
    for text in ("1,234.5", "x", ""):
        with pytest.raises(ValueError, match="could not convert"):
            number_of(text)
