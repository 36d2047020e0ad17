"""OpenSim's tables of a motion: MOT of coordinates, TRC of the markers where the arm has them."""

import numpy as np
from scipy.spatial.transform import Rotation

from arm.base_pose import frame_0_poses, is_carried
from arm.marker_positions import marker_positions
from arm.model import Arm, Floats
from fitter.export.osim_model import BASE_COORDINATES


def coordinates_mot(arm: Arm, t: Floats, q: Floats, base: Floats | None) -> str:
    """Return the text of a MOT file of the coordinates that `osim_model` names, in rad and m.

    Parameters
    ----------
    arm : Arm
    t : (n_frame,) [s]
    q : (n_frame, n_joint) [rad or m]
    base : (n_frame, 7), or None
        Place and quaternion w, x, y, z of the segment that carries the arm, where one does.
    """
    names, columns = [f"q{i + 1}" for i in range(arm.n_joint)], q
    if base is not None and is_carried(arm):
        turns = Rotation.from_quat(base[:, [4, 5, 6, 3]]).as_euler("XYZ")
        names = [*BASE_COORDINATES, *names]
        columns = np.hstack([np.unwrap(turns, axis=0), base[:, :3], q])
    head = [
        "coordinates", "version=1", f"nRows={len(t)}", f"nColumns={len(names) + 1}", "inDegrees=no", "endheader",
        "\t".join(["time", *names]),
    ]  # fmt: skip
    rows = ["\t".join(f"{x:.9g}" for x in (at, *row)) for at, row in zip(t, columns, strict=True)]
    return "\n".join([*head, *rows, ""])


def marker_places(arm: Arm, q: Floats, base: Floats | None) -> Floats:
    """Return where an arm has its markers in the world, (n_frame, n_marker, 3) [m]; parameters as above."""
    R, p = frame_0_poses(arm, base if is_carried(arm) else None)
    return np.asarray(marker_positions(arm, q) @ R.mT + p[:, None])


def markers_trc(name: str, markers: list[str], t: Floats, places: Floats, rate_hz: float) -> str:
    """Return the text of a TRC file, in metres.

    Parameters
    ----------
    name : str
        Of the file.
    markers : list of str
    t : (n_frame,) [s]
    places : (n_frame, n_marker, 3) [m]
    rate_hz : float
    """
    n, m, rate = len(t), len(markers), f"{rate_hz:.9g}"
    lines = [
        f"PathFileType\t4\t(X/Y/Z)\t{name}",
        "DataRate\tCameraRate\tNumFrames\tNumMarkers\tUnits\tOrigDataRate\tOrigDataStartFrame\tOrigNumFrames",
        f"{rate}\t{rate}\t{n}\t{m}\tm\t{rate}\t1\t{n}",
        "Frame#\tTime\t" + "\t\t\t".join(markers) + "\t\t",
        "\t\t" + "\t".join(f"{axis}{k + 1}" for k in range(m) for axis in "XYZ"),
        "",
    ]
    for k, (at, row) in enumerate(zip(t, places.reshape(n, -1), strict=True)):
        lines.append("\t".join([str(k + 1), f"{at:.9g}", *(f"{x:.6f}" for x in row)]))
    return "\n".join([*lines, ""])
