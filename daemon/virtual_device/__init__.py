"""The virtual device: an arm, its sensors, its serial port, and faults to inject."""
