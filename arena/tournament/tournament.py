"""What is raced: the frozen, validated description of a tournament."""

from collections.abc import Iterable
from dataclasses import asdict, dataclass
from functools import cached_property
from typing import Any

from arena.common.html import represent
from arena.common.plain import plain
from arena.statistics.sequential import ADAPTIVE, MAX_REPLICATES, looks
from arena.tournament.conditions import Conditions, Evaluation, Run, Training, _integers
from arena.tournament.entrant import Entrant
from arena.tournament.readings import find_reading
from envs import Hill
from envs.foundation.checks import instance, number
from envs.foundation.errors import InvalidTypeError, InvalidValueError


@dataclass(frozen=True)
class Tournament:
    """Entrants that learn on one hill and are tested from the same starts.

    Args:
        entrants: with names that differ.
        hill: what they all drive on.
        training: how long they learn.
        evaluation: how long they are tested.
        replicates: independent repetitions of each entrant, at least 1; or ``"adaptive"``: as many as
            it takes to decide the first place, see ``arena.statistics.sequential``.
        seed: master of all random streams, at least 0.
        name: what the tournament is called.
        reading: how to read the paper's protocol where its text leaves it open; see
            ``arena.tournament.readings``. A reading other than ``"literal"`` changes the hill and sets those
            parameters of the entrants that were not given.
        time_limit: seconds that a run may take in its worker, the worker's start included; None is
            no limit. A run that breaks a limit fails, the others go on.
        memory_limit: mebibytes that a worker may use; None is no limit.
        max_replicates: where adaptive replicates end in any case.
        confidence: 1 - the probability that adaptive replicates end with a difference that is none.
        leaders: how many of the first places adaptive replicates decide.

    Raises:
        TypeError, ValueError: when an argument breaks its rule.
    """

    entrants: tuple[Entrant, ...]
    hill: Hill = Hill()  # noqa: RUF009 (immutable)
    training: Training = Training()  # noqa: RUF009 (immutable)
    evaluation: Evaluation = Evaluation()  # noqa: RUF009 (immutable)
    replicates: int | str = 10
    seed: int = 0
    name: str = "tournament"
    reading: str = "literal"
    time_limit: float | None = None
    memory_limit: float | None = None
    max_replicates: int = 50
    confidence: float = 0.95
    leaders: int = 1

    def __post_init__(self) -> None:
        reading = find_reading(self.reading)
        for attribute, kind in (("hill", Hill), ("training", Training), ("evaluation", Evaluation)):
            instance(attribute, getattr(self, attribute), kind)
        if not isinstance(self.name, str) or not self.name.strip() or not self.name.isprintable():
            raise InvalidValueError(f"name must be a printable text that is not empty, got {self.name!r}")
        _integers(self, "", seed=0, max_replicates=1, leaders=1)
        if self.replicates != ADAPTIVE:
            _integers(self, "", replicates=1)
        for limit in ("time_limit", "memory_limit"):
            if getattr(self, limit) is not None:
                object.__setattr__(self, limit, number(limit, getattr(self, limit), 0, exclusive_low=True))
        hill = self.hill._replace(**reading.hill)
        object.__setattr__(self, "hill", hill)
        entrants = tuple(map(reading.read, _entrants(self.entrants)))
        object.__setattr__(self, "entrants", entrants)
        self._check_adaptive()

    def _check_adaptive(self) -> None:
        confidence = number("confidence", self.confidence, 0, 1, exclusive_low=True)
        object.__setattr__(self, "confidence", confidence)
        if self.replicates != ADAPTIVE:
            return
        if self.max_replicates > MAX_REPLICATES or confidence == 1.0:
            raise InvalidValueError(
                f"adaptive replicates need a confidence below 1 and at most {MAX_REPLICATES} replicates"
            )
        if not looks(len(self.entrants), self.max_replicates, confidence):
            enough = range(self.max_replicates, MAX_REPLICATES)
            least = next((n for n in enough if looks(len(self.entrants), n, confidence)), None)
            raise InvalidValueError(
                f"max_replicates must be at least {least} to tell {len(self.entrants)} entrants apart at "
                f"{100.0 * confidence:g}% confidence, got {self.max_replicates}"
            )

    @property
    def most_replicates(self) -> int:
        """How many there may be of each entrant."""
        return self.max_replicates if isinstance(self.replicates, str) else self.replicates

    @cached_property
    def conditions(self) -> Conditions:
        """What all runs have in common."""
        return Conditions(self.hill, self.training, self.evaluation, self.seed)

    @cached_property
    def runs(self) -> tuple[Run, ...]:
        """All runs that there may be, replicate by replicate."""
        return tuple(Run(e, r) for r in range(self.most_replicates) for e in self.entrants)

    def _repr_html_(self) -> str:
        return represent(self)

    def to_dict(self) -> dict[str, Any]:
        """All of it as plain values; two tournaments are the same if these are equal."""
        return {
            "name": self.name,
            "reading": self.reading,
            "seed": self.seed,
            "replicates": self.replicates,
            "hill": _constants(self.hill),
            "training": asdict(self.training),
            "evaluation": asdict(self.evaluation),
            "time_limit": self.time_limit,
            "memory_limit": self.memory_limit,
            **(
                {name: getattr(self, name) for name in ("max_replicates", "confidence", "leaders")}
                if self.replicates == ADAPTIVE
                else {}
            ),
            "entrants": [entrant.to_dict() for entrant in self.entrants],
        }


def _entrants(entrants: Iterable[Any]) -> tuple[Entrant, ...]:
    named = tuple(entrants) if isinstance(entrants, Iterable) else (entrants,)
    for entrant in named:
        if not isinstance(entrant, Entrant):
            raise InvalidTypeError(f"entrants must be Entrant objects, got {entrant!r}")
    names = [entrant.name for entrant in named]
    if not names:
        raise InvalidValueError("entrants must be one or more, got none")
    if len(set(names)) < len(names):
        twice = next(name for name in names if names.count(name) > 1)
        raise InvalidValueError(f"entrants must have names that differ, got {twice!r} twice")
    return named


def _constants(hill: Hill) -> dict[str, Any]:
    """All of them; one that version 0.1.0 did not have only where it changes anything: digests stay."""
    constants: dict[str, Any] = plain(hill)
    if hill.goal_reward == Hill().goal_reward:
        del constants["goal_reward"]
    return constants
