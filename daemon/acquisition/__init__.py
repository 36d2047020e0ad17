"""From the serial line to a ring of bytes in shared memory, and the device's introduction."""
