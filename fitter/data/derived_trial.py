"""A motion on a uniform grid to a trial: derivatives computed, all columns filtered alike, the ends trimmed."""

import numpy as np

from arm.drive_state import drives_of
from fitter.data.derivatives import differentiate, lowpass
from fitter.data.drives import let_go
from fitter.data.jumps import midway_at_jumps
from fitter.data.plausibility.saturated import CONTRADICTED
from fitter.data.resample import Uniform
from fitter.data.trial import Trial
from fitter.data.trial_filter import trimmed_samples
from limbcal.note import Note
from protocol.tables.columns import DRIVE_ROLES

#: Share of a resampled value that must come from contradicted samples for it to be one; 0 but for rounding.
_CONTRADICTED_SHARE = 1e-3


def derive(motion: Uniform, cutoff_hz: float, band_hz: float) -> Trial:
    """Fill in what a motion on a uniform grid lacks, and filter all columns alike if anything was."""
    measured, dt_s = motion.measured, motion.dt_s
    columns, said = let_go(measured.columns, measured.where)
    drives = drives_of(columns)
    given = {name: values for name, values in columns.items() if name not in (CONTRADICTED, *DRIVE_ROLES)}
    marked = columns.get(CONTRADICTED)
    notes = [*measured.notes, *said]
    derived = [name for name in ("dq", "ddq") if name not in given]
    trim = 0
    kept_whole = ("q", "dq", "ddq", "ref", "tau", CONTRADICTED, *(() if drives is None else DRIVE_ROLES))
    whole = {name: columns[name] for name in kept_whole if name in columns}
    if "tau" in whole:
        whole["tau"] = midway_at_jumps(whole["tau"])
    if derived:
        given |= {name: whole[name] for name in ("tau",) if name in whole}
        trim = trimmed_samples(len(measured.t), dt_s, cutoff_hz)
        reference = given.pop("ref", None)  # a command is known exactly
        given = {name: lowpass(values, dt_s, cutoff_hz) for name, values in given.items()}
        if reference is not None:
            # A target is held from one sample to the next, so it comes half a step late as seen by the samples.
            held = (reference + np.vstack([reference[:1], reference[:-1]])) / 2
            given |= {"ref": reference, "ref_filtered": lowpass(held, dt_s, cutoff_hz)}
        source = "dq" if "dq" in given else "q"
        if "dq" not in given:
            given["dq"] = differentiate(given["q"], dt_s)
        if "ddq" not in given:
            given["ddq"] = differentiate(given[source], dt_s, 1 if source == "dq" else 2)
        filtered = "unfiltered" if trim == 0 else f"all columns but ref low-passed at {cutoff_hz:.4g} Hz"
        notes.append(Note("derived", f"{', '.join(derived)} derived from {source} (zero phase, {filtered})"))
    if trim:
        notes.append(Note("trimmed", f"{trim * dt_s:.3g} s trimmed at each end"))
    inner = slice(trim, len(measured.t) - trim)
    tau_measured = columns["tau"][inner] if "tau" in columns else None
    kept = {name: values[inner] for name, values in given.items()}
    return Trial(
        name=measured.name,
        t=measured.t[: len(measured.t) - 2 * trim],
        dt_s=dt_s,
        q=kept["q"],
        dq=kept["dq"],
        ddq=kept["ddq"],
        tau=kept.get("tau"),
        ref=kept.get("ref"),
        tip=kept.get("tip"),
        notes=tuple(notes),
        cutoff_hz=cutoff_hz,
        band_hz=band_hz,
        points=kept.get("points"),
        role=measured.role,
        ref_filtered=kept.get("ref_filtered"),
        tau_measured=tau_measured,
        whole=whole if derived else {},
        trimmed=trim,
        began_s=motion.began_s + trim * dt_s,
        contradicted=None if marked is None else marked[inner] > _CONTRADICTED_SHARE,
        draws=None if measured.draws is None or derived else measured.draws,
        drives=None if drives is None else drives.rows(inner),
        label=measured.label,
        piece_of=measured.piece_of,
        target_std=measured.target_std,
    )
