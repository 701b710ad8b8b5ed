"""Results of a tournament: the file, what is read from it, and the agents that it trained."""

from arena.results.digests import digest
from arena.results.results import Results, load
from arena.results.store import ResultsError
from arena.results.trained import Trained, UnknownPolicyError

__all__ = ["Results", "ResultsError", "Trained", "UnknownPolicyError", "digest", "load"]
