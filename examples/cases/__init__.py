"""Measured data, diagnosed: one page a case under ``docs/cases``, each made by one command."""
