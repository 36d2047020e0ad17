"""Recordings: how they are written, recovered and read again."""
