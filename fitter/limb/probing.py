"""Bony points that a pointer's tip touched: where they are in their segment, and in every frame of recordings.

A pointer is a rigid body with markers whose tip is known among them. While it rests on a bony point, its pose and
that of the segment's own markers say where the point is in the segment (CAST; Cappozzo et al. 1995); the segment
then carries it wherever it is seen.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from fitter.functional.anatomy import LANDMARKS
from fitter.functional.marker_set import MarkerSet
from fitter.functional.rigid_fit import fit_poses
from fitter.functional.segment_motion import segment_motion
from limbcal.errors import ConfigError, DataError
from limbcal.note import Note
from protocol.markers.recording import MarkerRecording

#: How far a tip that rests on a point may stray in the segment, rms [m]: one examiner finds a point again within 6
#: to 21 mm (Della Croce, Cappozzo, Kerrigan 1999); a tip that strays so far while it is held is on no point.
_RESTS_M = 0.01


@dataclass(frozen=True)
class Probed:
    """Recordings with the points that were probed.

    Attributes
    ----------
    recordings : tuple of MarkerRecording
        Each with one more marker a point, where its segment has a pose.
    marker_set : MarkerSet
        In which those are landmarks.
    notes : tuple of Note
        How still the tip was on each.
    """

    recordings: tuple[MarkerRecording, ...]
    marker_set: MarkerSet
    notes: tuple[Note, ...]


def with_probed(
    recordings: Sequence[MarkerRecording], probings: Mapping[str, MarkerRecording], marker_set: MarkerSet
) -> Probed:
    """Add probed bony points to recordings.

    Parameters
    ----------
    recordings : sequence of MarkerRecording
    probings : mapping of str to MarkerRecording
        By landmark: the recording in which the tip rests on it.
    marker_set : MarkerSet
        With a probe.

    Raises
    ------
    ConfigError
        If the set has no probe, or no markers on a landmark's segment.
    DataError
        If a recording does not show probe and segment together, or the tip does not rest.
    """
    if len(marker_set.probe) < 3:
        raise ConfigError(
            f"marker set {marker_set.name} has {len(marker_set.probe)} markers under [probe], expected three or "
            "more and where they are when the tip is at the origin"
        )
    found, notes = list(recordings), list[Note]()
    landmarks = dict(marker_set.landmarks)
    for landmark, probing in probings.items():
        if landmark not in LANDMARKS:
            raise ConfigError(f"--probe {landmark}: no such landmark, expected one of {', '.join(LANDMARKS)}")
        name = landmarks.setdefault(landmark, landmark)
        segment = LANDMARKS[landmark]
        # the tracking cluster alone where it can: skin moves most over the bony points themselves
        on_it = [m for m in marker_set.segments.get(segment, ()) if m != name]
        tracking = [m for m in on_it if m not in marker_set.landmarks.values()]
        on_it = tracking if len(tracking) >= 3 else on_it
        if len(on_it) < 3:
            raise ConfigError(f"--probe {landmark}: {segment} has {len(on_it)} markers, expected three or more")
        motion = segment_motion(segment, on_it, [one.of(on_it) for one in (probing, *found)])
        pose = motion.trials[0]
        tip = fit_poses(np.array(list(marker_set.probe.values())), probing.of(list(marker_set.probe))).p
        local = pose.to_segment(tip)
        local = local[np.isfinite(local).all(axis=1)]
        if not len(local):
            raise DataError(f"{probing.path}: no frame shows probe and {segment} together, expected some")
        place = np.median(local, axis=0)
        strays = float(np.sqrt(np.mean(np.sum((local - place) ** 2, axis=1))))
        if strays > _RESTS_M:
            raise DataError(
                f"{probing.path}: the tip strays by {1e3 * strays:.0f} mm rms in {segment}, expected it to "
                f"rest on {landmark}, within {1e3 * _RESTS_M:.0f} mm"
            )
        text = f"{landmark} is where the probe's tip rested on {segment}, within {1e3 * strays:.1f} mm rms"
        notes.append(Note("probed", text, source=probing.path, columns=(name,)))
        for k, one in enumerate(found):
            world = np.einsum("nij,j->ni", motion.trials[k + 1].R, place) + motion.trials[k + 1].p
            found[k] = one.with_marker(name, world)
    computed = marker_set.computed | {landmarks[landmark] for landmark in probings}
    return Probed(tuple(found), replace(marker_set, landmarks=landmarks, computed=computed), tuple(notes))
