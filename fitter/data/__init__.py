"""Motions as they come: files, columns, rates and gaps."""
