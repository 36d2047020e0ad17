"""Which rivals get a row, and what stands in it."""

from fitter.report.diagnosis_rivals import Rival, shown, table_rows


def listed(*gains):
    return [Rival(f"candidate {k}", gain, "beaten", "#888") for k, gain in enumerate(gains)]


def test_what_takes_away_next_to_nothing_gets_no_row_unless_it_leads():
    rows, rest = shown(listed(0.005, 0.4, 0.3, 0.005, 0.0))
    assert [one.gain for one in rows] == [0.005, 0.4, 0.3]
    assert [one.gain for one in rest] == [0.005, 0.0]


def test_rows_are_limited_and_none_is_lost():
    every = listed(*[0.9 - 0.01 * k for k in range(40)])
    rows, rest = shown(every)
    assert rows + rest == every and len(rows) < len(rest)


def test_the_residuals_ratio_is_to_the_first():
    rows = table_rows(listed(0.8, 0.4))
    assert [row[1:3] for row in rows] == [("80 %", "1 ×"), ("40 %", "3 ×")]
