"""Pictures of a person's limb: stick figure in anatomical planes, angles, errors of markers, gaps and swaps."""

from collections.abc import Sequence

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.patches import Ellipse

from arm.model import Floats
from fitter.limb.inverse_kinematics import link_poses, predicted
from fitter.limb.limb_fit import LimbFit
from fitter.limb.marker_observations import SWAY
from fitter.report.figures import ERROR, MEASURED, SIMULATED
from limbcal.note import Note
from protocol.markers.recording import MarkerRecording, runs

#: Planes by the axes of frame 0 (forward, left, up) that are drawn to the right and upwards.
_PLANES = (("sagittal", 0, 2), ("frontal", 1, 2), ("transverse", 0, 1))
_AXES = ("forward [m]", "left [m]", "up [m]")
#: Half-axes of the ellipse that holds a point of the plane with 95 %, in standard deviations.
_ELLIPSE = float(np.sqrt(-2.0 * np.log(0.05)))
#: Half the length that an axis is drawn with [m].
_AXIS_M = 0.06


def stick_figure(fit: LimbFit) -> Figure:
    """Draw the limb in the middle frame of the fit: links, centres and their 95 % ellipses, axes, markers."""
    frames = fit.task.frames
    k = len(frames.t) // 2
    chain = fit.bundle.markers.chain(fit.bundle.geometry)
    one, q = frames.rows(np.array([k])), fit.bundle.q[[k]]
    R, o = (x[0] for x in link_poses(chain, one, q))
    R0, o0 = R[SWAY - 1], o[SWAY - 1]

    def here(x: Floats) -> Floats:
        return np.asarray((x - o0) @ R0)

    joints = here(np.vstack([o[SWAY:], o[-1] + fit.bundle.geometry.numbers[-1, 1] * R[-1][:, 0]]))
    seen, modelled = here(one.y[0]), here(predicted(chain, one, q)[0])
    figure = Figure(figsize=(12, 5), layout="constrained")
    for axes, (name, across, upward) in zip(figure.subplots(1, 3), _PLANES, strict=True):
        plane = [across, upward]
        axes.plot(*joints[:, plane].T, "-", color="#555", lw=3, label="chain")
        axes.plot(*seen[:, plane].T, "o", color=MEASURED, ms=5, label="markers, measured")
        axes.plot(*modelled[:, plane].T, "x", color=SIMULATED, ms=6, label="markers, modelled")
        for joint in fit.where.axes.values():
            way = R0.T @ R[SWAY + joint][:, 2]
            ends = here(o[SWAY + joint])[None] + _AXIS_M * np.array([[-1.0], [1.0]]) * way
            axes.plot(*ends[:, plane].T, "-", color="#2a7f3f", lw=1)
        _centres(axes, fit, R0, R, here(o), plane)
        axes.set(title=f"{name} plane", xlabel=_AXES[across], ylabel=_AXES[upward], aspect="equal")
    figure.axes[0].legend(fontsize="small")
    return figure


def _centres(axes: Axes, fit: LimbFit, R0: Floats, R: Floats, points: Floats, plane: list[int]) -> None:
    """Draw the ellipses of the centres: the base's turned with frame 0, the others with their links."""
    cov, at = fit.errors.derived_covariance, len(fit.errors.apart[0].lengths) if fit.errors.apart else 2
    names = list(fit.where.centres)
    for name in names:
        own = cov[at : at + 3, at : at + 3]
        at += 3
        link = SWAY + fit.where.centres[name]
        if name == names[0]:
            turned = fit.bundle.geometry.base_R.T @ own @ fit.bundle.geometry.base_R
        else:
            T = R0.T @ R[link - 1]
            turned = T @ own @ T.T
        flat = turned[np.ix_(plane, plane)]
        if not np.isfinite(flat).all():
            continue
        values, ways = np.linalg.eigh(flat)
        width, height = 2.0 * _ELLIPSE * np.sqrt(np.maximum(values, 0.0))
        place = points[link][plane]
        angle = float(np.degrees(np.arctan2(ways[1, 0], ways[0, 0])))
        axes.add_patch(Ellipse(tuple(place), width, height, angle=angle, color=ERROR, alpha=0.35))
        axes.annotate(name, tuple(place), textcoords="offset points", xytext=(6, 6), fontsize="small")


def angles_over_time(fit: LimbFit) -> Figure:
    """Draw the joints' angles in the frames of the fit, trial after trial [deg]."""
    frames, n = fit.task.frames, len(fit.arm.joints)
    figure = Figure(figsize=(12, 1.3 * n + 0.6), layout="constrained")
    rows = figure.subplots(n, 1, sharex=True)
    offset = 0.0
    for trial in np.unique(frames.trial):
        own = frames.trial == trial
        t = frames.t[own] - frames.t[own][0] + offset
        for i in range(n):
            rows[i].plot(t, np.degrees(fit.bundle.q[own, SWAY + i]), color=MEASURED, lw=1)
            rows[i].set_ylabel(f"q{i + 1} [°]")
        offset = float(t[-1]) + 0.5
    rows[-1].set_xlabel("time, trials one after the other [s]")
    return figure


def marker_errors(per_marker_mm: Sequence[tuple[str, float]], anatomical: set[str]) -> Figure:
    """Draw the rms of every marker, those on bony points and those that only track apart [mm]."""
    order = sorted(per_marker_mm, key=lambda one: (one[0] not in anatomical, -one[1]))
    figure = Figure(figsize=(12, 0.24 * len(order) + 1.2), layout="constrained")
    axes = figure.subplots()
    colours = [SIMULATED if name in anatomical else MEASURED for name, _ in order]
    axes.barh(range(len(order)), [rms for _, rms in order], color=colours)
    axes.set_yticks(range(len(order)), [name for name, _ in order], fontsize="small")
    axes.invert_yaxis()
    axes.set_xlabel("rms distance from the model [mm]; orange: on bony points, blue: tracking only")
    return figure


def gaps_and_swaps(recordings: Sequence[MarkerRecording], names: Sequence[str], notes: Sequence[Note]) -> Figure:
    """Draw when each marker was not seen, and when labels were exchanged, recording after recording."""
    figure = Figure(figsize=(12, 0.2 * len(names) + 1.2), layout="constrained")
    axes = figure.subplots()
    begin = 0.0
    for recording in recordings:
        dt = 1.0 / recording.rate_hz
        for k, name in enumerate(names):
            if name in recording.names:
                gone = runs(recording.missing[:, recording.names.index(name)])
                bars = [(begin + first * dt, (last - first) * dt) for first, last in gone]
            else:
                bars = [(begin, len(recording.positions) * dt)]
            axes.broken_barh(bars, (k - 0.35, 0.7), color="#999")
        end = begin + len(recording.positions) * dt
        for note in notes:
            if note.kind == "swapped" and recording.path.endswith(note.source or "?"):
                last = end if note.to_s is None else begin + note.to_s
                first = begin if note.from_s is None else begin + note.from_s
                for name in set(note.columns) & set(names):
                    axes.broken_barh([(first, last - first)], (list(names).index(name) - 0.2, 0.4), color=ERROR)
        axes.axvline(end, color="#ccc", lw=0.8)
        begin = end
    axes.set_yticks(range(len(names)), names, fontsize="small")
    axes.set(
        xlabel="time, recordings one after the other [s]; grey: not seen, red: labels exchanged", xlim=(0, begin)
    )
    axes.set_ylim(len(names) - 0.5, -0.5)
    return figure
