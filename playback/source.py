"""What can be played: the trials of one recording, file or simulation, and the arm that moves."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field

from arm.model import Arm
from limbcal.errors import ConfigError
from limbcal.note import Note
from playback.trajectory import Trajectory


@dataclass(frozen=True)
class Source:
    """Trials by number.

    Parameters
    ----------
    name : str
        What subscribers see as the source of the motion.
    arm : Arm
        The arm whose tip and sensor points are computed from the joints.
    durations_s : mapping of int to float
        Length of every trial [s].
    trajectory : callable
        Gives the motion of a trial; a simulation does its work here.
    twin : Source, optional
        The virtual arm beside this one, with the same trials on the same clock.
    notes : tuple of Note
        What was found while reading.
    begins_s : mapping of int to float
        When each trial began on the clock of what was read [s]; 0 where it does not say.
    names : mapping of str to int
        Numbers of the trials that have names.
    """

    name: str
    arm: Arm
    durations_s: Mapping[int, float]
    trajectory: Callable[[int], Trajectory]
    twin: "Source | None" = None
    notes: tuple[Note, ...] = ()
    begins_s: Mapping[int, float] = field(default_factory=dict)
    names: Mapping[str, int] = field(default_factory=dict)

    @property
    def trials(self) -> tuple[int, ...]:
        """Numbers of the trials, rising."""
        return tuple(sorted(self.durations_s))

    def load(self, trial: int | None = None) -> Trajectory:
        """Return a trial's motion, by default the first one's, between its nodes within the joints' limits.

        Raises
        ------
        ConfigError
            If there is no such trial.
        """
        number = self.trials[0] if trial is None else trial
        if number not in self.durations_s:
            there = ", ".join(str(known) for known in self.trials)
            raise ConfigError(f"{self.name}: there is no trial {number}, expected one of {there}")
        return self.trajectory(number).within([joint.limits for joint in self.arm.joints])
