"""What `fitter subscribe` shows at the terminal while it follows a stream."""

import numpy as np
from rich.console import Group
from rich.table import Table
from rich.text import Text

from fitter.live.calibration import Calibration
from fitter.live.stream import MotionAssembler


def live_table(calibration: Calibration, assembler: MotionAssembler, missed: int) -> Group:
    """Return the state of a calibration: the stream, the geometry, the dynamics."""
    state = f"motion {assembler.trial} ({assembler.role})" if assembler.moving else "at rest"
    stream = Text(
        f"{assembler.frames} frames, {missed} messages missed, {state}; "
        f"{len(calibration.learn)} learnt from, {len(calibration.evaluate)} for evaluation"
    )
    table = Table(box=None, pad_edge=False)
    for column in ("parameter", "value", "std", "95 % interval", "unit"):
        table.add_column(column, justify="left" if column in ("parameter", "unit") else "right")
    geometry = calibration.kinematics()
    fits = [fit for fit in (geometry, calibration.dynamics) if fit is not None]
    for fit in fits:
        for name, p in fit.parameters.items():
            if p.identifiable and p.ci95 is not None:  # what nobody knows the error of is not known
                value, low, high = (f"{number:.{_decimals(p.std)}f}" for number in (p.value, *p.ci95))
                table.add_row(name, value, f"{p.std:.2g}", f"{low} to {high}", p.unit)
        table.add_section()
    search = Text(
        f"geometry: generation {calibration.geometry.generations}, "
        f"tip off by {1e3 * calibration.geometry.tip_rms_m:.3g} mm rms"
        if geometry is not None
        else "geometry: nothing can be told yet"
    )
    return Group(stream, search, table)


def _decimals(std: float) -> int:
    """Return to how many decimals a value is worth telling: two digits of its standard error."""
    return 6 if std <= 0.0 else int(np.clip(1 - np.floor(np.log10(std)), 0, 9))
