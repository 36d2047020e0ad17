"""Measured recordings, diagnosed: one page a case under ``docs/cases``, each made by `fitter diagnose`."""
