"""Leaves when it is imported."""

import sys

sys.exit("a module should not do this")
