"""Receiving beside the work: a thread takes what comes off the socket, however long its owner is busy."""

import threading
from types import TracebackType
from typing import Any

import zmq

from limbcal.errors import DeviceError
from protocol.message import decode
from protocol.spilling_queue import SpillingQueue
from protocol.subscriber import Subscriber

#: How soon the thread notices that it is to end [ms], and how long it may take to [s].
_LOOK_MS = 50
_JOIN_S = 10.0


class Inbox:
    """What a subscriber receives, kept in order until its owner takes it: in memory, and then on the disk.

    Parameters
    ----------
    subscriber : Subscriber
        Nobody else may receive from it while the inbox is open; whoever made it closes it.
    queue : SpillingQueue, optional
    """

    def __init__(self, subscriber: Subscriber, queue: SpillingQueue | None = None) -> None:
        self._subscriber = subscriber
        self._queue = SpillingQueue() if queue is None else queue
        self._over = threading.Event()
        self._trouble: DeviceError | None = None
        self._thread = threading.Thread(target=self._gather, name="inbox", daemon=True)

    def start(self) -> None:
        """Receive from now on. Whoever starts it must be sure to close it, also when interrupted right after."""
        self._thread.start()

    def __len__(self) -> int:
        """Messages that wait."""
        return len(self._queue)

    def receive(self, timeout_ms: int) -> tuple[str, dict[str, Any]] | None:
        """Return topic and fields of the next message, or None if none came in time.

        Raises
        ------
        ProtocolError
            If the message is not one, or of another version; it is used up, and the next can be received.
        DeviceError
            If memory and disk are full: everything that came until then was handed out.
        """
        parts = self._queue.take(1e-3 * timeout_ms)
        if parts is not None:
            return decode(parts)
        if self._trouble is not None:
            raise self._trouble
        return None

    def stop(self) -> None:
        """Receive no more; what has come can still be taken. Harmless when repeated."""
        self._over.set()
        if self._thread.ident is not None:
            self._thread.join(_JOIN_S)

    def close(self) -> None:
        """Receive no more and forget what waits; harmless when repeated."""
        self.stop()
        self._queue.close()

    def __enter__(self) -> "Inbox":
        self.start()
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self.close()

    def _gather(self) -> None:
        try:
            while not self._over.is_set():
                if self._subscriber.socket.poll(_LOOK_MS):
                    self._drain()
        except DeviceError as error:
            self._trouble = error
        except zmq.ContextTerminated:
            return

    def _drain(self) -> None:
        while not self._over.is_set():
            try:
                parts = self._subscriber.take()
            except zmq.Again:
                return
            self._queue.put(parts)
