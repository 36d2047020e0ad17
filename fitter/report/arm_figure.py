"""A picture of an arm: its links with their lengths, its joints, its sensors."""

from collections.abc import Mapping, Sequence

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from arm.kinematics import axis_frames
from arm.model import Arm, Floats
from fitter.report.figures import ERROR, MEASURED, SIMULATED, png
from fitter.report.parameter_listing import parameter_rows
from fitter.search.fitted_parameter import FittedParameter
from limbcal.digits import plain

#: How far joints are bent to and fro, so that links are seen apart [rad].
_BEND_RAD = 0.6
#: Where an arm that fills space is looked at from: azimuth and elevation [rad].
_AZIMUTH_RAD, _ELEVATION_RAD = np.deg2rad((-60.0, 25.0))
#: Least and greatest height of the picture [inch].
_HEIGHT_IN = (2.4, 5.0)
#: Fraction of an arm's size below which its thickness is flat.
_FLAT = 1e-3


def arm_figure(arm: Arm, fitted: Mapping[str, FittedParameter] | None = None) -> bytes:
    """Draw an arm with its lengths.

    Parameters
    ----------
    arm : Arm
        Of any number of joints.
    fitted : mapping from name to FittedParameter, optional
        Learnt lengths (``a1``, ``d1``, …), to be listed with their 95 % intervals; others are the arm file's.

    Returns
    -------
    bytes
        PNG.
    """
    frames = axis_frames(arm, _bent(arm)[None])[0]
    origins, along = frames[:, :3, 3], frames[:, :3, 0]
    far = origins + np.array([[joint.a_m] for joint in arm.joints]) * along
    near = np.array([_hangs_at(arm, i, frames, far) for i in range(arm.n_joint)])
    sensors = [_place(frames, sensor.joint, sensor.position_m) for sensor in arm.sensors]
    view = _view(np.vstack([near, origins, far, *[place[None] for place in sensors]]))
    width, height = np.ptp(np.vstack([near, far]) @ view.T, axis=0)
    size = float(max(width, height)) or 1.0
    figure = Figure(figsize=(9.0, float(np.clip(6.3 * height / size + 1.0, *_HEIGHT_IN))), layout="constrained")
    axes, text = figure.subplots(1, 2, width_ratios=(2.4, 1.0))
    for k in range(arm.n_joint):
        _segment(axes, view, near[k], origins[k], f"d{k + 1}", size, dashed=True)
        _segment(axes, view, origins[k], far[k], f"a{k + 1}", size, dashed=False)
    _joints(axes, origins @ view.T, size)
    tip = far[-1] @ view.T
    axes.plot(*tip, marker="o", ms=5, color=MEASURED, zorder=4)
    for sensor, place in zip(arm.sensors, sensors, strict=True):
        at = place @ view.T
        rod = np.array([origins[sensor.joint - 1] @ view.T, at])
        axes.plot(*rod.T, color=SIMULATED, lw=0.8, zorder=1)
        axes.plot(*at, marker="s", ms=7, color=SIMULATED, zorder=5)
        _label(axes, sensor.name, at, (7.0, -10.0), SIMULATED, 9, "left")
    _base(axes, view, size)
    axes.set_aspect("equal")
    axes.margins(0.16)
    axes.axis("off")
    text.axis("off")
    text.text(0.0, 0.95, "\n".join(_listed(arm, fitted or {})), va="top", fontsize=10, linespacing=1.6)
    return png(figure)


def _bent(arm: Arm) -> Floats:
    signs = np.where(np.arange(arm.n_joint) % 2 == 0, 1.0, -1.0)
    turning = np.array([joint.type == "revolute" for joint in arm.joints])
    return np.where(turning, _BEND_RAD * signs, 0.0)


def _view(points: Floats) -> Floats:
    """Return the two directions that the picture's x and y axes show, (2, 3)."""
    centred = points - points.mean(axis=0)
    _, spread, directions = np.linalg.svd(centred, full_matrices=True)
    if len(spread) < 3 or spread[2] <= _FLAT * spread[0]:
        normal = directions[2]
        if normal @ np.array([0.3, -0.5, 1.0]) < 0.0:  # seen from above, or from the side where y points away
            normal = -normal
        x = np.eye(3)[int(np.argmin(np.abs(normal[:2])))]  # the base axis that lies best in the plane
        right = x - (x @ normal) * normal
        right /= np.linalg.norm(right)
        return np.vstack([right, np.cross(normal, right)])
    c, s = np.cos(_AZIMUTH_RAD), np.sin(_AZIMUTH_RAD)
    down = np.sin(_ELEVATION_RAD)
    return np.array([[-s, c, 0.0], [-down * c, -down * s, np.cos(_ELEVATION_RAD)]])


def _hangs_at(arm: Arm, i: int, frames: Floats, far: Floats) -> Floats:
    """Return where a joint hangs, in the base frame, (3,)."""
    parent, place = arm.parents[i], arm.joints[i].parent_position_m
    if place is not None:
        return _place(frames, parent + 1, place) if parent >= 0 else np.array(place)
    return far[parent] if parent >= 0 else np.zeros(3)


def _place(frames: Floats, joint: int, position: Sequence[float]) -> Floats:
    place: Floats = frames[joint - 1, :3, 3] + frames[joint - 1, :3, :3] @ np.asarray(position)
    return place


def _segment(
    axes: Axes, view: Floats, begin: Floats, end: Floats, name: str, size: float, *, dashed: bool
) -> None:
    """Draw a link's length or offset, with its name on the side."""
    if np.linalg.norm(end - begin) <= _FLAT * size:
        return
    p, q = begin @ view.T, end @ view.T
    axes.plot(
        *np.array([p, q]).T, color=MEASURED, lw=2.5 if dashed else 6.0, ls=":" if dashed else "-", alpha=0.85
    )
    direction = (q - p) / (np.linalg.norm(q - p) or 1.0)
    side = np.array([-direction[1], direction[0]])
    side = side if side[1] >= 0.0 else -side
    _label(axes, name, 0.5 * (p + q), (14.0 * side[0], 14.0 * side[1]), MEASURED, 10, "center")


def _joints(axes: Axes, places: Floats, size: float) -> None:
    """Draw joints; those on one spot share a circle and a label."""
    spots: list[tuple[Floats, list[int]]] = []
    for number, place in enumerate(places, 1):
        spot = next((s for s in spots if np.linalg.norm(s[0] - place) <= _FLAT * size), None)
        if spot is None:
            spots.append((place, [number]))
        else:
            spot[1].append(number)
    for place, numbers in spots:
        axes.plot(*place, marker="o", ms=13, mfc="white", mec=MEASURED, mew=2.5, zorder=6)
        said = f"joint {numbers[0]}" if len(numbers) == 1 else f"joints {', '.join(map(str, numbers))}"
        _label(axes, said, place, (-9.0, 12.0), "black", 9, "right")


def _label(
    axes: Axes, text: str, at: Floats, offset: tuple[float, float], color: str, size: float, side: str
) -> None:
    """Write a word near a point; the offset is in points."""
    place = (float(at[0]), float(at[1]))
    axes.annotate(
        text,
        place,
        offset,
        textcoords="offset points",
        ha="left" if side == "left" else "right" if side == "right" else "center",
        va="center",
        color=color,
        fontsize=size,
        zorder=7,
    )


def _base(axes: Axes, view: Floats, size: float) -> None:
    """Draw the axes of frame 0 that are seen."""
    axes.plot(0.0, 0.0, marker="^", ms=12, color="#888888", zorder=0)
    for name, direction in zip("xyz", np.eye(3), strict=True):
        shown = 0.16 * size * direction @ view.T
        if np.linalg.norm(shown) > 0.03 * size:
            x, y = float(shown[0]), float(shown[1])
            axes.annotate("", (x, y), (0.0, 0.0), arrowprops={"arrowstyle": "->", "color": ERROR, "lw": 1.2})
            _label(axes, f"{name}0", 1.25 * shown, (0.0, 0.0), ERROR, 8, "center")


def _listed(arm: Arm, fitted: Mapping[str, FittedParameter]) -> list[str]:
    """Return the lengths that are not zero, a line each."""
    printed = {row.name: row for row in parameter_rows(fitted, {})}
    lines = []
    for k, joint in enumerate(arm.joints, 1):
        for name, value in ((f"a{k}", joint.a_m), (f"d{k}", joint.d_m)):
            row = printed.get(name)
            if row is not None and fitted[name].identifiable:
                around = "" if row.half_width == "–" else f" ± {row.half_width}"
                lines.append(f"{name} = {row.value}{around} m")
            elif value != 0.0:
                lines.append(f"{name} = {plain(value)} m (arm file)")
    return lines or ["all lengths are zero"]
