"""An arm under a controller whose gains nobody knows: gains and base parameters at once, eq. (5) to (7)."""
