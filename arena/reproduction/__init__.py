"""The paper: what it prints, and what we measure beside it."""
