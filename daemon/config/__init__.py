"""`limbd.toml`, the flags beside it, and the files that `limbd check` is given."""
