"""Who is connected to a socket, and when one of them is shown out.

ZeroMQ bounds the size of one part and the number of whole messages that wait; parts of a message that does not end
it gathers where nobody sees them. So what the kernel has received of a connection (TCP_INFO) is held against what
its owner was handed. Only connections over TCP are measured: a socket in a folder admits nobody but its owner.
"""

import itertools
import os
import socket as posix
import struct
import threading
import time
from dataclasses import dataclass

import zmq
from zmq.utils.monitor import recv_monitor_message

#: How often connections are looked at [s]: what one can send in that time is what it can send too much.
LOOK_S = 0.01
#: Connections that a socket has at most; beyond, one that has said nothing yet goes, or else the newcomer.
MOST_CONNECTIONS = 250
#: Bytes a second that are not held against a peer: heartbeats (ZMTP 3.1, 9 bytes each), topics that change.
FREE_BYTES_S = 100.0
#: What is counted for each part beside its bytes: its header, and what CURVE adds.
PART_OVERHEAD = 64
#: How long an address may take to say who it is [ms].
HANDSHAKE_MS = 3000
#: Where `struct tcp_info` (linux/tcp.h) has its u64 of all bytes received, and its size up to there.
_RECEIVED_AT, _INFO_BYTES = 128, 136
#: How often one looks while there is no connection, and how long the thread may take to end [s].
_IDLE_S, _JOIN_S = 0.02, 10.0
_MADE = zmq.EVENT_ACCEPTED | zmq.EVENT_CONNECTED
_EVENTS = _MADE | zmq.EVENT_DISCONNECTED
#: Bytes thrown away at once of a peer that is shown out.
_DISCARD = 1 << 20
#: `struct linger` (socket(7)): on, and no time.
_RESET = struct.pack("ii", 1, 0)

#: Of a socket's events, as a number: of an enum it takes longer than the look itself, and to poll longer still.
READABLE = int(zmq.POLLIN)

#: Numbers of the monitors of a process.
_NUMBERS = itertools.count()


@dataclass
class _Connection:
    """A connection that ZeroMQ holds: its descriptor's inode, since when, and the bytes that were handed on."""

    inode: int
    since_s: float
    handed: int = 0
    heard: bool = False


class Peers:
    """The connections of one socket; made before it is bound or connected.

    Parameters
    ----------
    context : zmq.Context
    socket : zmq.Socket
    unread_limit : int
        Bytes that a connection may have sent and that nobody was handed, beyond `FREE_BYTES_S`.

    Attributes
    ----------
    refused : int
        Connections that were ended from here.
    """

    def __init__(
        self, context: "zmq.Context[zmq.Socket[bytes]]", socket: "zmq.Socket[bytes]", unread_limit: int
    ) -> None:
        self.refused = 0
        self._limit = unread_limit
        self._open: dict[int, _Connection] = {}
        self._gone: set[int] = set()  # inodes that were refused and may still be heard of
        self._lock = threading.Lock()
        self._due_s = 0.0
        self._over = threading.Event()
        self._thread: threading.Thread | None = None
        self._socket = socket
        socket.set(zmq.HANDSHAKE_IVL, HANDSHAKE_MS)
        name = f"inproc://peers-{next(_NUMBERS)}"  # a name is free some time after its socket has closed
        socket.monitor(name, _EVENTS)
        self._monitor = context.socket(zmq.PAIR)
        self._monitor.set(zmq.RCVHWM, 0)  # full, it would hold up the thread that carries all messages
        self._monitor.set(zmq.LINGER, 0)
        self._monitor.connect(name)

    def watch(self) -> None:
        """Look from a thread of its own, where the owner may be busy with something else."""
        self._thread = threading.Thread(target=self._watch, name="peers", daemon=True)
        self._thread.start()

    def look(self) -> None:
        """Look at the connections, if it is time; for an owner that comes by often enough and has no thread."""
        if self._thread is None and time.monotonic() >= self._due_s:
            self._look()

    def handed(self, frame: zmq.Frame, n_byte: int = 0) -> tuple[int, int] | None:
        """Take note of what the owner was handed; return which connection it is of, None where there is none.

        Parameters
        ----------
        frame : zmq.Frame
            The first part of a message.
        n_byte : int
            Bytes of the whole message, and of what each part takes beside.

        Returns
        -------
        (int, int)
            Descriptor and inode, which no other has as long as this one is open.
        """
        try:
            descriptor = int(frame.get(zmq.SRCFD))
            inode = os.fstat(descriptor).st_ino
        except (zmq.ZMQError, OSError):  # of this process, as ZeroMQ itself says, or closed meanwhile
            return None
        with self._lock:
            known = self._open.get(descriptor)
            if known is None or known.inode != inode:  # a newcomer, with the number of one that went
                self._hear(time.monotonic())
            connection = self._open.get(descriptor)
            if connection is not None and connection.inode == inode:
                connection.handed += n_byte
                connection.heard = True
        return descriptor, inode

    def is_refused(self, inode: int) -> bool:
        """Say whether a connection was shown out: what is still heard of it counts for nothing."""
        return inode in self._gone

    def refuse(self, descriptor: int, inode: int) -> None:
        """End a connection."""
        with self._lock:
            self._hear(time.monotonic())
            self._refuse(descriptor, inode)

    def close(self) -> None:
        """Look no more; to be called before the socket is closed. Harmless when repeated."""
        self._over.set()
        if self._thread is not None:
            self._thread.join(_JOIN_S)
        if not self._monitor.closed:
            self._socket.disable_monitor()
            self._monitor.close(0)

    def _watch(self) -> None:
        try:
            while not self._over.is_set():
                self._over.wait(LOOK_S if self._open else _IDLE_S)
                self._look()
        except zmq.ZMQError as error:
            # an owner that was interrupted leaves the end of its sockets to the context
            if not self._monitor.closed and not isinstance(error, zmq.ContextTerminated):
                raise

    def _look(self) -> None:
        now_s = time.monotonic()
        self._due_s = now_s + LOOK_S
        with self._lock:
            self._hear(now_s)
            for descriptor, connection in list(self._open.items()):
                free = self._limit + FREE_BYTES_S * (now_s - connection.since_s)
                received = _received(descriptor)
                connection.handed = min(connection.handed, received)  # what parts take is guessed: no credit of it
                if connection.inode not in self._gone and received - connection.handed > free:
                    self._refuse(descriptor, connection.inode)

    def _hear(self, now_s: float) -> None:
        """Take in who has come and who has gone."""
        while int(self._monitor.get(zmq.EVENTS)) & READABLE:
            event = recv_monitor_message(self._monitor)
            if event["event"] & _MADE:
                self._accept(event["value"], now_s)
            elif (gone := self._open.pop(event["value"], None)) is not None:
                self._gone.discard(gone.inode)

    def _accept(self, descriptor: int, now_s: float) -> None:
        try:
            inode = os.fstat(descriptor).st_ino
        except OSError:
            return  # gone already
        self._open[descriptor] = _Connection(inode, now_s)
        if len(self._open) - len(self._gone) > MOST_CONNECTIONS:
            mute = (fd for fd, one in self._open.items() if not one.heard and one.inode not in self._gone)
            descriptor = next(mute, descriptor)  # the one that has been silent for longest
            self._refuse(descriptor, self._open[descriptor].inode)

    def _refuse(self, descriptor: int, inode: int) -> None:
        connection = self._open.get(descriptor)
        if connection is None or connection.inode != inode or inode in self._gone:
            return  # it has gone by itself, or is about to go
        try:
            own = os.dup(descriptor)
            if os.fstat(own).st_ino != inode:
                os.close(own)
                return  # another one has the number by now
            with posix.socket(fileno=own) as line:
                # closed with a reset: no kernel keeps what a peer that does not listen was still to be sent
                line.setsockopt(posix.SOL_SOCKET, posix.SO_LINGER, _RESET)
                self._gone.add(inode)
                self.refused += 1
                line.shutdown(posix.SHUT_RDWR)
                while line.recv(_DISCARD, posix.MSG_DONTWAIT):  # what it had sent, so that ZeroMQ sees none of it
                    pass
        except OSError:
            return  # it has gone by itself


def _received(descriptor: int) -> int:
    """Return the bytes that came over a TCP connection since it was made; 0 where that is not known."""
    try:
        line = posix.socket(posix.AF_INET, posix.SOCK_STREAM, 0, fileno=descriptor)
    except OSError:
        return 0  # closed, which is reported later
    try:
        info = line.getsockopt(posix.IPPROTO_TCP, posix.TCP_INFO, _INFO_BYTES)
    except OSError:
        return 0  # not over TCP
    finally:
        line.detach()  # it is ZeroMQ's
    return struct.unpack_from("<Q", info, _RECEIVED_AT)[0] if len(info) >= _INFO_BYTES else 0
