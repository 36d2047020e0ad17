"""Arms with something hidden in them: drawn by a seed, simulated by code that is not the fitter's."""
