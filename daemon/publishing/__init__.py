"""Blocks of samples and of motion, and the way they leave."""
