"""Data that contradict themselves, given to the real commands."""
