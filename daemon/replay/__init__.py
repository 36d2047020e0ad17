"""A recording that is a device once more."""
