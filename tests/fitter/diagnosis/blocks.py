"""Fitted models of made-up residuals."""

import numpy as np

from arm.model import Floats
from fitter.diagnosis.evidence import Fit
from fitter.diagnosis.hypotheses import hypotheses
from fitter.diagnosis.model import Candidate, Model

#: Rows a block, blocks a trial, places in the motion.
ROWS, BLOCKS, CELLS = 20, 5, 40


def fit_of(residual: Floats, numbers: int = 0, learnt: int | None = None) -> Fit:
    """Return a model that has this many numbers and leaves this of one joint, of unit variance.

    Parameters
    ----------
    residual : (n_row,)
    numbers : int
    learnt : int, optional
        So many trials, the first ones, may be learnt from; all unless given.
    """
    one = next(one for one in hypotheses(1) if one.n_number == 1)
    n_block = len(residual) // ROWS
    trial = np.arange(n_block) // BLOCKS
    may = trial < (trial[-1] + 1 if learnt is None else learnt)
    candidate = Candidate(Model((one,) * numbers, (np.zeros(0),) * numbers), np.zeros(numbers), np.zeros(n_block))
    block = np.arange(len(residual)) // ROWS
    count = ROWS * np.bincount(trial)[:, None].astype(np.float64)
    cell = (np.arange(len(residual)) % CELLS)[:, None]
    acts = np.ones((numbers, trial[-1] + 1), dtype=np.bool_)
    return Fit(candidate, residual[:, None], count, block, trial, may, cell, np.zeros(n_block), acts)
