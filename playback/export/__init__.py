"""Motions as files that other programs open: glTF, CSV, MP4, GIF, and MCAP for Foxglove."""
