"""The acquisition service: serial port, tracking, ZeroMQ, disk; and the virtual device."""
