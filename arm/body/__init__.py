"""Persons' arms and legs: segments by published tables, and the chains that carry them."""
