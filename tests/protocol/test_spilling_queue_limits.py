"""What is in memory and what on the disk, message by message."""

import pytest

from limbcal.errors import DeviceError
from protocol.spilling_queue import FILE_BYTES, MEMORY_BYTES, SpillingQueue


def test_64_mib_of_each_are_kept() -> None:
    assert MEMORY_BYTES == FILE_BYTES == 64 * 2**20


def test_a_message_that_fills_memory_is_kept_there_and_the_next_is_not() -> None:
    queue = SpillingQueue(10, 1000)
    for parts, memory, spilled in (([b"1234"], 4, 0), ([b"123", b"456"], 10, 0), ([b""], 10, 0), ([b"a"], 10, 9)):
        queue.put(parts)
        assert (queue.memory, queue.spilled) == (memory, spilled)
    assert len(queue) == 4
    queue.close()
    assert (len(queue), queue.memory, queue.spilled) == (0, 0, 0)


def test_what_waits_on_the_disk_is_loaded_until_half_of_memory_is_full() -> None:
    """Four bytes at a time; after the third there are twelve, more than half of twenty."""
    queue = SpillingQueue(20, 1000)
    for k in range(11):
        queue.put([b"%04d" % k])
    assert queue.memory == 20
    for k in range(5):
        assert queue.take() == [b"%04d" % k]
    assert queue.memory == 0
    assert queue.take() == [b"0005"]
    assert queue.memory == 8  # of twelve
    assert [queue.take(), queue.take()] == [[b"0006"], [b"0007"]]
    assert queue.memory == 0 and queue.spilled == 3 * 12
    assert [queue.take(), queue.take(), queue.take(), queue.take()] == [[b"0008"], [b"0009"], [b"0010"], None]
    queue.close()


def test_a_message_beyond_memory_is_loaded_alone() -> None:
    queue = SpillingQueue(2, 1000)
    for k in range(3):
        queue.put([b"%04d" % k])
    assert queue.take() == [b"0000"] and queue.memory == 0
    assert queue.take() == [b"0001"] and queue.memory == 0
    queue.close()


@pytest.mark.parametrize(("file_bytes", "files"), [(12, 3), (13, 2), (24, 2), (25, 1), (36, 1)])
def test_a_file_that_is_full_is_followed_by_another(file_bytes: int, files: int) -> None:
    """A message of four bytes takes twelve on the disk."""
    queue = SpillingQueue(0, file_bytes)
    for k in range(3):
        queue.put([b"%04d" % k])
    assert len(queue._files) == files
    assert [queue.take() for _ in range(3)] == [[b"0000"], [b"0001"], [b"0002"]]
    assert len(queue._files) == 0
    queue.close()


def test_while_messages_wait_on_the_disk_the_next_go_there_too() -> None:
    queue = SpillingQueue(5, 1000)
    queue.put([b"12345"])
    queue.put([b"6"])
    assert queue.take() == [b"12345"]
    queue.put([b"7"])
    assert (queue.memory, queue.spilled) == (0, 18)
    assert [queue.take(), queue.take()] == [[b"6"], [b"7"]]
    queue.put([b"8"])
    assert (queue.memory, queue.spilled) == (1, 0)
    queue.close()


def test_a_disk_that_does_not_give_back_is_said() -> None:
    queue = SpillingQueue(0, 1000)
    queue.put([b"1"])
    queue._files[0]._file.truncate(3)
    with pytest.raises(DeviceError, match="messages that waited on the disk cannot be read again"):
        queue.take()
    queue.close()
