"""Which runs of a tournament come before which look; all at once if its replicates are a number."""

from collections.abc import Collection

from arena.analysis.scores import scores_of
from arena.results.results import Results
from arena.results.store import Store
from arena.statistics.sequential import ADAPTIVE, Look, decided, looks
from arena.tournament.conditions import Run
from arena.tournament.tournament import Tournament

Stage = tuple[tuple[Run, ...], Look | None]


def stages_of(tournament: Tournament, only: range) -> list[Stage]:
    """The runs until each look, and the look; None where nothing is looked at.

    Args:
        tournament: what is raced.
        only: the replicates that are run, where their number is fixed.
    """
    if tournament.replicates != ADAPTIVE:
        return [(tuple(run for run in tournament.runs if run.replicate in only), None)]
    entrants = len(tournament.entrants)
    all_looks = looks(entrants, tournament.max_replicates, tournament.confidence)
    starts = [0, *(look.replicates for look in all_looks)]
    return [
        (tournament.runs[entrants * start : entrants * look.replicates], look)
        for start, look in zip(starts, all_looks)
    ]


def pending_runs(
    tournament: Tournament, stages: list[Stage], store: Store | None, done: Collection[tuple[str, int]]
) -> list[Run]:
    """What may have to be run: nothing if what is finished decides.

    Args:
        tournament: what is raced.
        stages: its runs.
        store: of an earlier start, if there was one.
        done: entrant and replicate of the runs that are finished in it.
    """
    pending: list[Run] = []
    for stage, look in stages:
        pending += [run for run in stage if run.key not in done]
        if store and look and not pending and is_decided(tournament, store, look):
            break
    return pending


def is_decided(tournament: Tournament, store: Store, look: Look) -> bool:
    """Whether the places that the tournament is to decide are decided at ``look``."""
    return decided(scores_of(Results(store)).costs("steps"), look, tournament.leaders)
