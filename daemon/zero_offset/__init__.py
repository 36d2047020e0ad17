"""`limbd zero`: the accelerometers' offsets from an arm at rest."""
