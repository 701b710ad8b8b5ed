"""Results on a page, in a terminal, in a notebook."""
