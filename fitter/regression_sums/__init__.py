"""Regression sums: trials of any length reduced to sums of products of their equations."""
