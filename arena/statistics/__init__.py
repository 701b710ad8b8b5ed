"""Statistics over replicates; knows no tournament."""
