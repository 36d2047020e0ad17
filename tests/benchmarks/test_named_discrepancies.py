"""Cases of the bench as files, and the page of what was said of them."""

import numpy as np

from benchmarks.discrepancies import EFFECTS, RATE_HZ, SECONDS
from benchmarks.named_discrepancies import MOTIONS, NOTHING, Job, jobs, page, write


def test_all_effects_are_there_in_three_sizes_and_nothing_once_a_seed():
    some = jobs(range(2))
    assert len(some) == 2 * (1 + 3 * len(EFFECTS)) == len({job.key for job in some})
    assert sum(job.effect == NOTHING for job in some) == 2


def test_each_motion_is_a_file_whose_clock_begins_at_zero(tmp_path):
    paths = write(tmp_path, Job("late sensor", 0.01, 0))
    assert len(paths) == MOTIONS
    for path in paths:
        with np.load(path) as table:
            assert table["t"][0] == 0.0 and len(table["t"]) == round(SECONDS * RATE_HZ)


def test_only_the_effects_own_readings_differ_from_those_of_nothing(tmp_path):
    (tmp_path / "a").mkdir()
    (tmp_path / "b").mkdir()
    late = write(tmp_path / "a", Job("late sensor", 0.01, 3))[0]
    sound = write(tmp_path / "b", Job(NOTHING, 0.0, 3))[0]
    with np.load(late) as one, np.load(sound) as other:
        differ = [name for name in one.files if not np.array_equal(one[name], other[name])]
    assert set(differ) <= {"s4x", "s4y", "s4z"} and differ


def test_the_page_counts_right_and_wrong_and_lists_what_was_not_right():
    case = {"effect": "flex", "size": 0.01}
    right = {"right": True, "wrong": [], "seconds": 3.0, "said": "unexplained"}
    wrong = {"right": False, "wrong": ["time_skew"], "seconds": 5.0, "said": "named: time_skew"}
    failed = {"error": "TimeoutError: late"}
    lines = [case | {"key": f"flex/0.01/{k}"} | one for k, one in enumerate((right, wrong, failed))]
    text = page(lines)
    assert "| flex | 0.01 rad | unexplained | 3 | 1 | 1 | 1 | 5 |" in text
    assert "flex/0.01/1 | named: time_skew" in text and "flex/0.01/2 | TimeoutError: late" in text
