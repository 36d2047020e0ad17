"""A whole person from recordings of markers: a tree with a floating pelvis, fitted and tracked."""
