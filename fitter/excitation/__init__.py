"""Motions that reveal an arm: what to ask of it, within what it may do."""
