"""Models of the hill and what planning with them needs."""
