"""BLAS in one thread, set before numpy is loaded, unless the environment says otherwise.

Our matrices are small: several threads of BLAS wait for one another longer than they work, and take the processors
from the processes that ``--workers`` starts.
"""

import os

for name in ("OPENBLAS_NUM_THREADS", "OMP_NUM_THREADS", "MKL_NUM_THREADS"):
    os.environ.setdefault(name, "1")
