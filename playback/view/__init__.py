"""The page in the browser: the arm in 3D, its virtual twin, and what controls them."""
