"""The page of `fitter kinematics --body human-body --report`: a whole person, to hand on."""

from collections.abc import Sequence
from pathlib import Path

import numpy as np
from matplotlib.figure import Figure

from arm.model import Floats
from fitter.body.body_fit import BodyFit
from fitter.limb.base_orientation import world_up
from fitter.limb.inverse_kinematics import link_poses
from fitter.report.figures import MEASURED, SIMULATED, png
from fitter.report.limb_page import Answer, of_the_markers, results
from fitter.report.page import Page
from limbcal.note import Note
from protocol.markers.recording import MarkerRecording


def write_body_page(
    path: Path, fit: BodyFit, answer: Answer, recordings: Sequence[MarkerRecording], notes: Sequence[Note]
) -> None:
    """Write the page.

    Parameters
    ----------
    path : Path
    fit : BodyFit
    answer : mapping
        The command's JSON document.
    recordings : sequence of MarkerRecording
        Learning ones, then evaluating ones.
    notes : sequence of Note
        All that was said.

    Raises
    ------
    DeviceError
        If it cannot be written.
    """
    page = Page(fit.arm.name, f"{len(recordings)} recordings, {answer['samples']} frames in the fit")
    results(page, answer)
    page.picture(
        png(lowest_and_highest(fit)), "The frames in which the pelvis is at its highest and lowest; dots: markers."
    )
    of_the_markers(page, answer, fit.trials.landmarks.values(), fit.bundle.markers.names, recordings, notes)
    page.write(path)


def lowest_and_highest(fit: BodyFit) -> Figure:
    """Draw the highest and the lowest posture of the fit from the right: lines between joints, and markers."""
    frames, parent = fit.task.frames, fit.bundle.geometry.parent
    _, o = link_poses(fit.bundle.markers.chain(fit.bundle.geometry), frames, fit.bundle.q)
    up = world_up(fit.trials.up)
    forward = fit.start.world[:, 0]
    height = o[:, fit.where.links["pelvis"]] @ up
    figure = Figure(figsize=(9, 5), layout="constrained")
    for axes, k in zip(
        figure.subplots(1, 2, sharey=True), (int(np.argmax(height)), int(np.argmin(height))), strict=True
    ):

        def seen(x: Floats) -> tuple[Floats, Floats]:
            return x @ forward, x @ up

        for i, over in enumerate(parent.tolist()):
            if over >= fit.where.links["pelvis"]:
                axes.plot(*seen(o[k, [over, i]]), color=SIMULATED)
        axes.plot(*seen(frames.y[k]), ".", color=MEASURED, ms=4)
        axes.set_aspect("equal")
        axes.set(xlabel="forward [m]", ylabel="up [m]", title=f"{frames.t[k]:.2f} s")
    return figure
