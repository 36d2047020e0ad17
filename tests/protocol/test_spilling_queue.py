"""Nothing is lost, the order stays, memory is bounded, and the disk is given back."""

import os
import threading
from collections import deque

import pytest
from hypothesis import given
from hypothesis import strategies as st

from limbcal.errors import DeviceError
from protocol.spilling_queue import SpillingQueue

MEMORY_BYTES, FILE_BYTES, LARGEST = 40, 60, 30

messages = st.lists(st.binary(max_size=LARGEST // 2), min_size=1, max_size=2)


def test_messages_come_out_in_the_order_in_which_they_were_put():
    @given(st.lists(st.one_of(messages, st.none()), max_size=60))
    def check(steps):
        queue, model = SpillingQueue(MEMORY_BYTES, FILE_BYTES), deque()
        for step in steps:
            if step is None:
                assert queue.take() == (model.popleft() if model else None)
            else:
                queue.put(step)
                model.append(step)
            assert len(queue) == len(model)
            assert queue.memory <= MEMORY_BYTES + LARGEST
            in_files = sum(4 + sum(4 + len(part) for part in parts) for parts in model) + LARGEST + 12
            assert queue.spilled <= in_files
            assert len(queue._files) <= in_files // FILE_BYTES + 2
        while model:
            assert queue.take() == model.popleft()
        assert queue.take() is None and queue.memory == queue.spilled == 0
        queue.close()

    check()


def test_one_thread_puts_while_another_takes():
    queue, sent = SpillingQueue(MEMORY_BYTES, FILE_BYTES), [[b"topic", b"%d" % k] for k in range(3000)]
    thread = threading.Thread(target=lambda: [queue.put(parts) for parts in sent])
    thread.start()
    taken = [queue.take(60.0) for _ in sent]
    thread.join()
    assert taken == sent and len(queue) == 0


def test_waiting_in_vain_ends():
    assert SpillingQueue().take(0.001) is None


def open_files():
    return len(os.listdir("/proc/self/fd"))


def test_what_was_spilled_leaves_nothing_behind(tmp_path):
    before = open_files()
    queue = SpillingQueue(0, FILE_BYTES, tmp_path)
    for _ in range(20):
        queue.put([bytes(LARGEST)])
    assert open_files() > before + 1
    assert list(tmp_path.iterdir()) == []  # the files have no name
    for _ in range(20):
        queue.take()
    assert open_files() == before
    queue.put([b"x"])
    queue.close()
    queue.close()
    assert open_files() == before and queue.take() is None


def test_a_disk_that_takes_nothing_is_said_and_what_waits_stays(tmp_path):
    queue = SpillingQueue(4, FILE_BYTES, tmp_path / "gone")
    queue.put([b"1234"])
    with pytest.raises(DeviceError, match=r"gone: 1 messages wait, and the next cannot be written there: No such"):
        queue.put([b"5"])
    assert queue.take() == [b"1234"] and queue.take() is None


def test_a_record_that_was_cut_is_written_over(tmp_path):
    """As on a disk that was full for a moment: half of a record is there, and the next begins in its place."""
    queue = SpillingQueue(0, FILE_BYTES, tmp_path)
    queue.put([b"first"])
    file = queue._files[-1]
    file._file.seek(file.written)
    file._file.write(b"half of a rec")
    queue.put([b"second", b"part"])
    assert [queue.take(), queue.take(), queue.take()] == [[b"first"], [b"second", b"part"], None]


def test_memory_is_filled_to_the_last_byte_and_no_further():
    queue = SpillingQueue(4, FILE_BYTES)
    queue.put([b"12", b"34"])
    queue.put([b""])
    assert (queue.memory, queue.spilled, len(queue)) == (4, 0, 2)
    queue.put([b"5"])
    assert (queue.memory, queue.spilled, len(queue)) == (4, 4 + 4 + 1, 3)  # how many parts, how long, and the part
    queue.put([b"6", b""])  # behind what is on the disk, though it would fit into memory
    assert queue.take() == [b"12", b"34"]
    queue.put([b"7"])
    assert (queue.memory, queue.spilled) == (0, 9 + 13 + 9)
    assert [queue.take() for _ in range(4)] == [[b""], [b"5"], [b"6", b""], [b"7"]]
    assert (queue.memory, queue.spilled, len(queue)) == (0, 0, 0)
    queue.put([b"8"])
    assert (queue.memory, queue.spilled) == (1, 0)
    queue.close()


def test_half_of_memory_is_filled_from_the_disk():
    queue = SpillingQueue(8, 1000)
    for k in range(10):
        queue.put([b"%02d" % k])
    assert (queue.memory, queue.spilled) == (8, 6 * 10)
    for k in range(5):
        assert queue.take() == [b"%02d" % k]
    assert (queue.memory, queue.spilled) == (2, 4 * 10)  # of two that were taken over one is left
    assert [queue.take() for _ in range(5)] == [[b"%02d" % k] for k in range(5, 10)]
    queue.close()


@pytest.mark.parametrize(("file_bytes", "files"), [(18, 2), (19, 2), (9, 4), (27, 2), (28, 1), (36, 1)])
def test_a_file_that_is_full_is_followed_by_another(tmp_path, file_bytes, files):
    before = open_files()
    queue = SpillingQueue(0, file_bytes, tmp_path)
    for k in range(4):
        queue.put([b"%d" % k])  # nine bytes each
    assert open_files() - before == files
    queue.close()
    assert open_files() == before and len(queue) == queue.memory == queue.spilled == 0


def test_a_message_beyond_memory_is_loaded_alone() -> None:
    queue = SpillingQueue(2, 1000)
    for k in range(3):
        queue.put([b"%04d" % k])
    assert queue.take() == [b"0000"] and queue.memory == 0
    assert queue.take() == [b"0001"] and queue.memory == 0
    queue.close()


def test_a_disk_that_does_not_give_back_is_said() -> None:
    queue = SpillingQueue(0, 1000)
    queue.put([b"1"])
    queue._files[0]._file.truncate(3)
    with pytest.raises(DeviceError, match="messages that waited on the disk cannot be read again"):
        queue.take()
    queue.close()
