"""The state, what sensors read in it, and what is known before: shared by filter and smoother."""
