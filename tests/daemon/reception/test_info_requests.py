"""Which lost numbers may be those of INFO frames."""

import math
import sys

from daemon.reception.info_requests import InfoRequests

S = 10**9


def requests_at(*seconds: int) -> InfoRequests:
    requests = InfoRequests()
    for at_s in seconds:
        requests.sent(at_s * S)
    return requests


def test_a_device_that_was_asked_nothing_has_numbered_no_info() -> None:
    requests = InfoRequests()
    requests.answered()
    assert (requests.unanswered, requests.most, requests.unplugged) == (0, 0, False)


def test_a_request_is_unanswered_until_an_info_comes() -> None:
    requests = requests_at(0, 1, 2)
    requests.answered()
    assert requests.unanswered == requests.most == 2
    requests.answered(3)
    assert requests.unanswered == 0


def test_what_was_not_answered_for_five_seconds_of_samples_will_not_be() -> None:
    requests = requests_at(0, 1, 2)
    requests.samples_came(6 * S)
    assert requests.unanswered == 2
    requests.samples_came(6 * S + 1)
    assert requests.unanswered == 1


def test_overdue_requests_stay_open_until_samples_come_much_later() -> None:
    requests = requests_at(0, 2, 4, 6, 8)  # by the last, those at 0 and 2 are overdue
    requests.samples_came(7 * S)
    assert requests.unanswered == 5
    requests.samples_came(7 * S + 1)
    assert requests.unanswered == 3


def test_the_oldest_requests_are_answered_first() -> None:
    requests = requests_at(0, 2, 4, 6, 8)
    requests.answered(3)
    requests.samples_came(11 * S)
    assert requests.unanswered == 2
    requests.samples_came(11 * S + 1)
    assert requests.unanswered == 1


def test_an_unplugged_device_may_have_been_asked_by_anybody() -> None:
    requests = requests_at(0, 7)
    requests.lost_device()
    assert (requests.unanswered, requests.most, requests.unplugged) == (0, math.inf, True)
    requests.sent(8 * S)
    assert (requests.unanswered, requests.most) == (1, math.inf)
    requests.samples_came(9 * S)
    assert (requests.most, requests.unplugged) == (1, False)


def test_a_day_of_silence_needs_no_more_memory_than_a_minute() -> None:
    requests = requests_at(*range(0, 60, 2))
    minute = sum(map(sys.getsizeof, vars(requests).values()))
    for at_s in range(60, 86_400, 2):
        requests.sent(at_s * S)
    assert requests.unanswered == 43_200
    assert sum(map(sys.getsizeof, vars(requests).values())) < minute + 1000
