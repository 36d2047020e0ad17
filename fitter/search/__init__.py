"""Searches, least squares from sums, and standard errors."""
