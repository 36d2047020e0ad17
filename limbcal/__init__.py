"""What every package shares: the error family, the door of a command, compilation."""
