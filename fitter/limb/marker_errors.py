"""How far markers are from where a calibration has them, and which share of their motion that explains."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from arm.model import Floats
from fitter.kinematics.geometry_fit import LEAST_EXPLAINED
from fitter.limb.bundle import LEAST_STD_M
from fitter.limb.marker_observations import Frames
from limbcal.note import Note
from protocol.markers.recording import MarkerRecording

#: Skin takes a marker at most so far from its place on the bone [m]: up to 40 mm on the thigh (Cappozzo et al.
#: 1996, Position and orientation in space of bones during movement: experimental artefacts).
SKIN_M = 0.04


@dataclass(frozen=True)
class MarkerErrors:
    """Errors of markers.

    Attributes
    ----------
    distance_m : (n_frame, m)
        From where the chain has a marker [m]; NaN where it was not seen.
    moved_m : (n_frame, m)
        From the marker's mean place in the segment that carries the base, or in the laboratory [m].
    trial : (n_frame,) int
        Which recording a frame is of, from 0.
    """

    distance_m: Floats
    moved_m: Floats
    trial: NDArray[np.int64]

    @property
    def explained(self) -> float | None:
        """1 − square of the distances / square of the motion, over what was seen; None where nothing moved.

        Nor has anything moved where neither motion nor distance is more than skin makes: in a stance a marker that
        sits millimetres beside its place has more than the sway.
        """
        moved, off = float(np.nansum(self.moved_m**2)), float(np.nansum(self.distance_m**2))
        skin = 3.0 * LEAST_STD_M**2 * np.count_nonzero(np.isfinite(self.distance_m))
        return None if moved == 0.0 or max(moved, off) <= skin else 1.0 - off / moved


def hardly(explained: float) -> str:
    """Return a sentence for markers whose motion is hardly explained."""
    share = f"{100.0 * explained:.3g} %" if explained > 0.0 else "nothing"
    return (
        f"next to nothing of the markers' motion is explained ({share}; expected at least "
        f"{100.0 * LEAST_EXPLAINED:.3g} %): check the marker set, the recordings' labels and the preset's side"
    )


def marker_errors(frames: Frames, predicted: Floats) -> MarkerErrors:
    """Compare markers with where they are predicted.

    Parameters
    ----------
    frames : Frames
    predicted : (n_frame, m, 3) [m]
        In the world.
    """
    carried = np.einsum("kji,kmj->kmi", frames.R, frames.y - frames.p[:, None])
    seen = np.isfinite(carried)
    count = np.maximum(seen.sum(axis=0), 1)
    mean = np.where(seen, carried, 0.0).sum(axis=0) / count
    distance = np.linalg.norm(frames.y - predicted, axis=2)
    return MarkerErrors(distance, np.linalg.norm(carried - mean, axis=2), frames.trial)


class Fitted(Protocol):
    """A limb's or a person's fit."""

    def marker_errors(self, recordings: Sequence[MarkerRecording], seed: int) -> MarkerErrors:
        """Return how far every marker is from where the fit has it."""
        ...


def scores_of(
    fit: Fitted, learn: Sequence[MarkerRecording], evaluate: Sequence[MarkerRecording], seed: int
) -> dict[str, MarkerErrors]:
    """Return the errors of ``learn`` and, where there are such trials, ``evaluate``."""
    roles = {"learn": learn, "evaluate": evaluate}
    return {role: fit.marker_errors(recordings, seed) for role, recordings in roles.items() if recordings}


def beyond_skin(names: Sequence[str], distance_m: Floats) -> list[Note]:
    """Say which markers of a recording are farther from where the limb has them than skin takes any.

    Parameters
    ----------
    names : sequence of str
        Of the markers.
    distance_m : (n_frame, m)
        NaN where one was not seen.
    """
    seen = np.isfinite(distance_m)
    mean = np.sum(np.where(seen, distance_m, 0.0) ** 2, axis=0) / np.maximum(seen.sum(axis=0), 1)
    rms = np.sqrt(mean)
    off = np.flatnonzero(rms > SKIN_M).tolist()
    if not off:
        return []
    far = tuple(names[m] for m in off)
    size = f"{1e3 * rms[off].min():.0f}" + (f" to {1e3 * rms[off].max():.0f}" if len(off) > 1 else "")
    text = (
        f"{', '.join(far)}: {size} mm rms from where the calibrated person has them, farther than skin takes a "
        f"marker ({1e3 * SKIN_M:.0f} mm): labels are exchanged, a marker sits elsewhere than in other trials, or "
        "its segment is not the marker set's; `fitter diagnose` with this arm file shows which"
    )
    return [Note("beyond_skin", text, columns=far)]
