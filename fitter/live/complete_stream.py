"""A daemon's messages from the first of its run on, each once: what was missed is read from its recording."""

import time
from collections import deque
from collections.abc import Callable, Iterator, Mapping
from typing import Any

from limbcal.errors import ConfigError
from limbcal.note import Note
from protocol.inbox import Inbox
from protocol.message import FRAMES, HEALTH, TRIAL
from protocol.recording_follower import RecordingFollower

Message = tuple[str, dict[str, Any]]

#: What must be complete.
TOPICS = (FRAMES, TRIAL)
#: Time in which a recording, whose writer flushes twice a second, must grow before it is given up [s].
_PATIENCE_S = 10.0
#: Ten heartbeats: a daemon that has not said by then whether it records does not say it at all [s].
_HEARTBEATS_S = 10.0
#: … and this many messages: a minute of frames.
_HELD = 6000


class CompleteStream:
    """Hands out a daemon's messages in the order in which they were sent.

    Sequence numbers begin at 0 with each run. Where one does not follow the last, be it because the subscription
    began late or because messages were dropped, those in between are read from the recording that `limb/health`
    names, if it can be read here and is of the same run; what came twice is handed out once.

    Parameters
    ----------
    inbox : Inbox
    tell : callable
        Called with a note where something is missed for good, or the stream is of another arm.
    clock : callable
        Returns seconds that never go back.
    arm_name : str, optional
        Whose motions are expected; any arm's unless given.

    Attributes
    ----------
    missed : dict of str to int
        Messages that neither came nor were found, by topic.
    recovered : int
        Messages found in a recording.
    restarts : int
        How often the daemon turned out to be another run.
    """

    def __init__(
        self,
        inbox: Inbox,
        tell: Callable[[Note], None],
        clock: Callable[[], float] = time.monotonic,
        arm_name: str | None = None,
    ) -> None:
        self.missed: dict[str, int] = {}
        self.recovered = self.restarts = 0
        self._inbox, self._tell, self._clock = inbox, tell, clock
        self._arm_name = arm_name
        self._timeout_ms = 0
        self._run: object = None
        self._arm: object = None
        self._last: dict[str, int] = {}
        self._held: deque[Message] = deque()
        self._recording: str | None = None
        self._knows = False  # whether the daemon records
        self._follower: RecordingFollower | None = None
        self._recorded: Message | None = None  # read from it, and not handed out yet
        self._catching_up = False
        self._messages = self._follow()

    @property
    def waits(self) -> bool:
        """Whether messages wait that were not handed out yet."""
        return bool(len(self._inbox) or self._held or self._catching_up)

    def receive(self, timeout_ms: int) -> Message | None:
        """Return topic and fields of the next message, or None if there was none in time.

        Raises
        ------
        ProtocolError
            If a message is not one, or of another version; it is used up.
        ConfigError
            If another run is of an arm of another name.
        DeviceError
            If neither memory nor disk can keep what comes.
        """
        self._timeout_ms = timeout_ms
        try:
            return next(self._messages)
        except BaseException:  # the generator has ended with it
            self._messages = self._follow()
            raise

    def stop(self) -> None:
        """Receive no more; what waits is still handed out."""
        self._inbox.stop()

    def close(self) -> None:
        """Close the recording; harmless when repeated."""
        if self._follower is not None:
            self._follower.close()
            self._follower = None

    def _follow(self) -> Iterator[Message | None]:
        self._catching_up = False
        while True:
            message = self._live()
            if message is None:
                yield None
            else:
                yield from self._completed(*message)

    def _live(self) -> Message | None:
        return self._held.popleft() if self._held else self._inbox.receive(self._timeout_ms)

    def _completed(self, topic: str, fields: dict[str, Any]) -> Iterator[Message | None]:
        """Yield what was sent before a message and not handed out, and then the message unless it was."""
        self._begin_anew(fields.get("run"), fields.get("arm"))
        if topic == HEALTH:
            self._learn(fields)
        before = _sent_before(topic, fields)
        if not self._knows and any(last >= self._next(wanted) for wanted, last in before.items()):
            yield from self._hold(topic, fields)
            return  # it comes again, now that it is known whether there is a recording
        seq = _number(topic, fields)
        for wanted, last in before.items():
            # Up to the message itself, where it is one: what was sent right before it then comes right before it.
            came = wanted == topic and seq is not None
            yield from self._catch_up(wanted, last + 1 if came else last, came)
        if seq is None or seq >= self._next(topic):
            if seq is not None:
                self._last[topic] = seq
            yield topic, fields

    def _next(self, topic: str) -> int:
        return self._last.get(topic, -1) + 1

    def _begin_anew(self, run: object, arm: object) -> None:
        if run == self._run:
            return
        if self._run is not None and arm != self._arm:  # motions of two arms are none of either
            raise ConfigError(f"the daemon began anew with arm {arm!r}, expected {self._arm!r} as before")
        if self._run is None and self._arm_name not in (None, arm):
            text = (
                f"its arm is {arm!r}, and --arm is {self._arm_name!r}: what is learnt holds only if both are one"
            )
            self._tell(Note("other_arm", text, "stream"))
        self.restarts += self._run is not None
        self._run, self._arm = run, arm
        self._last.clear()
        self.close()
        self._recorded, self._recording, self._knows = None, None, False

    def _learn(self, fields: Mapping[str, Any]) -> None:
        recording = fields.get("recording")
        self._knows = True
        if isinstance(recording, str):
            self._recording = recording

    def _hold(self, topic: str, fields: dict[str, Any]) -> Iterator[None]:
        """Put messages aside until the heartbeat says where the run is recorded; none where it does not come."""
        self._catching_up = True
        held: deque[Message] = deque([(topic, fields)])
        deadline_s = self._clock() + _HEARTBEATS_S
        while not self._knows and len(held) < _HELD and self._clock() < deadline_s:
            message = self._live()
            if message is None:
                yield None
                continue
            held.append(message)
            if message[1].get("run") != self._run:
                break
            if message[0] == HEALTH:
                self._learn(message[1])
        self._knows = True
        self._held.extendleft(reversed(held))
        self._catching_up = False

    def _catch_up(self, topic: str, seq: int, came: bool = False) -> Iterator[Message | None]:
        """Yield the recording's messages up to one of a topic; count those that it does not have.

        Parameters
        ----------
        topic : str
        seq : int
        came : bool
            Whether that one came, and is there if the recording does not have it.
        """
        if self._next(topic) > seq - came:
            return
        self._catching_up = True
        quiet_s = self._clock() + _PATIENCE_S
        while self._next(topic) <= seq and self._recording is not None:
            message = self._next_recorded()
            if message is None:
                if not self._is_there() or self._clock() >= quiet_s:
                    break
                time.sleep(1e-3 * self._timeout_ms)
                yield None
                continue
            name, number = message[0], message[1]["seq"]
            if name == topic and number > seq:
                break
            self._recorded = None
            if number >= self._next(name):
                self._miss(name, number)
                self._last[name] = number
                self.recovered += 1
                yield message
            quiet_s = self._clock() + _PATIENCE_S
        self._miss(topic, seq if came else seq + 1)
        self._catching_up = False

    def _is_there(self) -> bool:
        return self._follower is not None and self._follower.found

    def _next_recorded(self) -> Message | None:
        """Return the next message of this run in its recording, again and again until it is taken."""
        if self._follower is None:
            assert self._recording is not None
            self._follower = RecordingFollower(self._recording, TOPICS)
        while self._recorded is None:
            message = self._follower.next()
            if message is None:
                return None
            if message[1].get("run") == self._run and isinstance(message[1].get("seq"), int):
                self._recorded = message
        return self._recorded

    def _miss(self, topic: str, before: int) -> None:
        """Count the messages of a topic up to, and without, a number."""
        missing = before - self._next(topic)
        if missing <= 0:
            return
        self.missed[topic] = self.missed.get(topic, 0) + missing
        where = f"{topic}: {missing} messages from number {self._next(topic)} on did not come"
        self._tell(Note("missed", f"{where}, and {self._why()}", "stream"))
        self._last[topic] = before - 1

    def _why(self) -> str:
        if self._recording is None:
            return "nothing is recorded from which they could be read"
        if not self._is_there():
            return f"the recording {self._recording} cannot be read here"
        return f"the recording {self._recording} does not have them"


def _number(topic: str, fields: Mapping[str, Any]) -> int | None:
    """Return a message's number, if it is one of those that must be complete."""
    seq = fields.get("seq")
    return seq if topic in TOPICS and isinstance(seq, int) else None


def _sent_before(topic: str, fields: Mapping[str, Any]) -> dict[str, int]:
    """Return the numbers of the last messages that were sent before one, by topic, as far as it tells."""
    reported = fields.get("last_seq")
    last = {wanted: reported.get(wanted) for wanted in TOPICS} if isinstance(reported, dict) else {}
    seq = _number(topic, fields)
    if seq is not None:
        last[topic] = seq - 1
    return {wanted: number for wanted, number in last.items() if isinstance(number, int)}
