"""What `fitter subscribe` shows at the terminal while it follows a stream."""

from rich.console import Group
from rich.table import Table
from rich.text import Text

from fitter.live.calibration import Calibration
from fitter.live.stream import MotionAssembler
from limbcal.digits import with_half_width


def live_table(calibration: Calibration, assembler: MotionAssembler, missed: int) -> Group:
    """Return the state of a calibration: the stream, the geometry, the dynamics."""
    state = f"motion {assembler.trial} ({assembler.role})" if assembler.moving else "at rest"
    stream = Text(
        f"{assembler.frames} frames, {missed} messages missed, {state}; "
        f"{len(calibration.learn)} learnt from, {len(calibration.evaluate)} for evaluation"
    )
    table = Table(box=None, pad_edge=False)
    for column in ("parameter", "value", "± (95 %)", "unit"):
        table.add_column(column, justify="left" if column in ("parameter", "unit") else "right")
    geometry = calibration.kinematics()
    fits = [fit for fit in (geometry, calibration.dynamics) if fit is not None]
    for fit in fits:
        for name, p in fit.parameters.items():
            if p.identifiable and p.ci95 is not None:  # without a known error a value is not known
                table.add_row(name, *with_half_width(p.value, p.half_width), p.unit)
        table.add_section()
    search = Text(
        f"geometry: generation {calibration.geometry.generations}, "
        f"tip off by {1e3 * calibration.geometry.tip_rms_m:.3g} mm rms"
        if geometry is not None
        else "geometry: nothing is identified yet"
    )
    return Group(stream, search, table)
