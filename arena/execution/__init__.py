"""Runs of a tournament: drivers, workers, checkpoints, the runner."""
