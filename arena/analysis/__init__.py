"""What results mean: scores, regret, standings, comparisons, curves, policy maps."""
