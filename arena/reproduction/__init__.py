"""The paper: what it prints, and what we measure beside it."""

from arena.reproduction.claims import paper_claims, results_claims
from arena.reproduction.goodness import Fit, fit, iterations_spread
from arena.reproduction.published_values import PAPER, published
from arena.reproduction.tables import Comparison, compare, paper_tables
from arena.reproduction.verdicts import Claim
from arena.reproduction.walk_study import WalkStudy, study

__all__ = [
    "PAPER",
    "Claim",
    "Comparison",
    "Fit",
    "WalkStudy",
    "compare",
    "fit",
    "iterations_spread",
    "paper_claims",
    "paper_tables",
    "published",
    "results_claims",
    "study",
]
