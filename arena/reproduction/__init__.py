"""The paper: what it prints, and what we measure beside it."""

from arena.reproduction.claims import paper_claims, results_claims
from arena.reproduction.published_values import PAPER, published
from arena.reproduction.tables import Comparison, compare, iterations_spread, paper_tables
from arena.reproduction.verdicts import Claim
from arena.reproduction.walk_study import WalkStudy, study

__all__ = [
    "PAPER",
    "Claim",
    "Comparison",
    "WalkStudy",
    "compare",
    "iterations_spread",
    "paper_claims",
    "paper_tables",
    "published",
    "results_claims",
    "study",
]
