"""How far markers are from where a calibration has them, and which share of their motion that explains."""

from dataclasses import dataclass

import numpy as np

from arm.model import Floats
from fitter.kinematics.geometry_fit import LEAST_EXPLAINED
from fitter.limb.bundle import LEAST_STD_M
from fitter.limb.marker_observations import Frames


@dataclass(frozen=True)
class MarkerErrors:
    """Errors of markers.

    Attributes
    ----------
    distance_m : (n_frame, m)
        From where the chain has a marker [m]; NaN where it was not seen.
    moved_m : (n_frame, m)
        From the marker's mean place in the segment that carries the base, or in the laboratory [m].
    """

    distance_m: Floats
    moved_m: Floats

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
    return MarkerErrors(np.linalg.norm(frames.y - predicted, axis=2), np.linalg.norm(carried - mean, axis=2))
