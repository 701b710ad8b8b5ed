"""Cells and binary features of observations."""
