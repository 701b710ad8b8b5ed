"""What becomes of the runs in a results file when its tournament changes."""

from collections.abc import Collection, Container, Iterable, Mapping
from dataclasses import dataclass
from itertools import groupby
from types import MappingProxyType
from typing import Any

from arena.statistics.sequential import ADAPTIVE

Key = tuple[str, int]  # entrant and replicate


@dataclass(frozen=True)
class Growth:
    """What a tournament finds in its results file, and what it still has to run.

    Attributes:
        kept: runs that are there, and finished.
        missing: runs that are not, in the order of the tournament.
        aside: finished runs that it does not need any more.
        reasons: of the entrants that are not what they were, why their runs are anew.
        at_most: whether it may do with less, as adaptive replicates do.
    """

    kept: frozenset[Key]
    missing: tuple[Key, ...]
    aside: int
    reasons: Mapping[str, str]
    at_most: bool

    @property
    def sentence(self) -> str:
        """It in words: "keeps 120 runs, runs 12: 10 of 'mine', whose code changed, 2 of replicate 5"."""
        parts = [f"keeps {_runs(len(self.kept))}"]
        if self.aside:
            parts.append(f"puts {self.aside} aside")
        what = [
            f"{sum(name == entrant for name, _ in self.missing)} of {entrant!r}, {reason}"
            for entrant, reason in self.reasons.items()
            if any(name == entrant for name, _ in self.missing)
        ]
        rest = [replicate for name, replicate in self.missing if name not in self.reasons]
        if rest:
            what.append(f"{len(rest)} of {_replicates(rest)}")
        count = f"{'at most ' * self.at_most}{len(self.missing)}"
        parts.append(f"runs {count}" + (f": {'; '.join(what)}" if what else ""))
        return ", ".join(parts)


def growth(
    now: Mapping[str, Any],
    versions: Mapping[str, str],
    replicates: range,
    only: Container[int],
    before: Mapping[str, Any] | None = None,
    before_versions: Mapping[str, str] = MappingProxyType({}),
    finished: Collection[Key] = (),
    past: Mapping[str, Collection[Key]] = MappingProxyType({}),
) -> Growth:
    """What is kept, and what has to be run, of the tournament ``now``.

    Args:
        now: the tournament, as plain values.
        versions: of its entrants, see ``versions_of``.
        replicates: those of the tournament.
        only: those of them that are to be run.
        before: the tournament in the file; None for a new file.
        before_versions: of its entrants.
        finished: its finished runs.
        past: those of former versions, by version.
    """
    same = {name for name, version in versions.items() if before_versions.get(name) == version}
    runs = [(name, replicate) for replicate in replicates for name in versions]
    stay = {run for run in runs if run[0] in same and run in finished}
    kept = stay | {run for run in runs if run in past.get(versions[run[0]], ())}
    entrants = {entrant["name"]: entrant for entrant in before["entrants"]} if before else {}
    reasons = {
        entrant["name"]: _reason(entrants.get(entrant["name"]), entrant)
        for entrant in now["entrants"]
        if before and entrant["name"] not in same
    }
    missing = tuple(run for run in runs if run not in kept and run[1] in only)
    return Growth(frozenset(kept), missing, len(finished) - len(stay), reasons, now["replicates"] == ADAPTIVE)


def _reason(before: Mapping[str, Any] | None, now: Mapping[str, Any]) -> str:
    if before is None:
        return "which is new"
    if before["agent"] != now["agent"]:
        return "which is another agent"
    if before["parameters"] != now["parameters"]:
        return "whose parameters changed"
    return "whose code changed"


def _runs(count: int) -> str:
    return f"{count} run{'s' * (count != 1)}"


def _replicates(numbers: Iterable[int]) -> str:
    """Replicates in words, neighbours together: "replicates 3 to 5 and 7"."""
    ordered = sorted(set(numbers))
    groups = [
        [n for _, n in group] for _, group in groupby(enumerate(ordered), lambda pair: pair[1] - pair[0])
    ]
    texts = [f"{group[0]} to {group[-1]}" if len(group) > 1 else str(group[0]) for group in groups]
    words = " and ".join(filter(None, [", ".join(texts[:-1]), texts[-1]]))
    return f"replicate{'s' * (len(ordered) > 1)} {words}"
