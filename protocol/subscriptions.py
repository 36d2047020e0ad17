"""What subscribers ask for, bounded: an XPUB socket tells of each topic, and whose it is."""

from collections import OrderedDict

import zmq

from protocol.peers import READABLE, Peers

#: Bytes of a topic at most; ours have 16.
TOPIC_LIMIT = 64
#: Topics that one subscriber has at most; there are ten.
MOST_TOPICS = 64
#: Bytes of what a subscriber may send at once: a topic, or the longest message of CURVE's handshake (RFC 26).
FRAME_LIMIT = 512
#: Bytes that a subscriber may send in all, beside what is free: its handshake and some hundred topics.
SENT_LIMIT = 32 * 1024
#: Topics that ZeroMQ takes in at a time of one subscriber: a flood cannot keep it from what is to be sent.
_AT_ONCE = 8
#: Subscribers whose topics are remembered; those who have not been heard for longest are forgotten, being gone.
_MOST_KNOWN = 1000
#: Bytes that the kernel keeps of what a subscriber sends.
_KERNEL_BYTES = 16 * 1024
#: Sent in one go; what remains is sent the next time.
_GO = 256


class Subscriptions:
    """The topics of an XPUB socket's subscribers; made before it is bound.

    Whoever asks for more, or for longer ones, or sends anything else, is shown out, and no other.
    """

    def __init__(self, context: "zmq.Context[zmq.Socket[bytes]]", socket: "zmq.Socket[bytes]") -> None:
        socket.set(zmq.XPUB_VERBOSER, 1)  # tells of what another one has asked for already, too
        socket.set(zmq.MAXMSGSIZE, FRAME_LIMIT)
        socket.set(zmq.RCVHWM, _AT_ONCE)
        socket.set(zmq.RCVBUF, _KERNEL_BYTES)
        self.peers = Peers(context, socket, SENT_LIMIT)
        self._socket = socket
        self._topics: OrderedDict[int, set[bytes]] = OrderedDict()
        self._joined = False

    def look(self) -> None:
        """Take in what subscribers ask for, and show out who asks for too much."""
        for _ in range(_GO):
            if not int(self._socket.get(zmq.EVENTS)) & READABLE:
                break
            frame = self._socket.recv(copy=False)
            connection = self.peers.handed(frame)
            if connection is None:  # of this process, or of somebody who has left
                self._joined = self._joined or frame.bytes.startswith(b"\x01")
            elif not self.peers.is_refused(connection[1]):
                self._take(connection, frame.bytes)
        self.peers.look()

    def joined(self) -> bool:
        """Say whether anybody asked for something since the last time."""
        joined, self._joined = self._joined, False
        return joined

    def _take(self, connection: tuple[int, int], said: bytes) -> None:
        descriptor, inode = connection
        topics = self._topics.setdefault(inode, set())
        self._topics.move_to_end(inode)
        if len(self._topics) > _MOST_KNOWN:
            self._topics.popitem(last=False)
        kind, topic = said[:1], said[1:]
        if kind == b"\x00":
            topics.discard(topic)
            return
        topics.add(topic)
        if kind != b"\x01" or len(topic) > TOPIC_LIMIT or len(topics) > MOST_TOPICS:
            del self._topics[inode]
            self.peers.refuse(descriptor, inode)
            return
        self._joined = True
