"""Random walks on the hill (paper, section 3.2)."""
