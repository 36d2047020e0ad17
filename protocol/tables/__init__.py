"""Tables of numbers as they come: one reader of every format, for every command."""
