"""Which markers contradict a calibrated arm or leg, and why: moved, exchanged, or carried by sliding skin."""
