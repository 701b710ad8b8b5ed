"""Policies from elsewhere, and for elsewhere."""
