"""Checks of parameters and random streams."""
