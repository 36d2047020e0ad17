"""What crosses a process boundary: serial frames, messages, recordings, topics."""
