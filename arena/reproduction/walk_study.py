"""What random walks say about the hill, beside what the paper says (section 3.2)."""

import math
from collections.abc import Sequence
from dataclasses import asdict, dataclass
from typing import Any

from arena.reproduction.published_values import PAPER, REASONABLE, Summary
from arena.walks.distributions import BOOTSTRAPS, Fit, fit_all
from arena.walks.series import RandomWalk
from envs import Hill, Integrator

LEVEL = 0.05
"""Of the tests of fit."""

_FAR = 3.0  # standard errors; beyond it a mean is another one than the paper's


def summarize(walk: RandomWalk) -> Summary:
    """The numbers of at least one finished episode."""
    lengths = walk.lengths
    return Summary(
        episodes=len(lengths),
        least=int(lengths.min()),
        most=int(lengths.max()),
        mean=float(lengths.mean()),
        deviation=float(lengths.std(ddof=1)) if len(lengths) > 1 else 0.0,
        position=walk.position,
        velocity=walk.velocity,
        share_below=float((lengths < REASONABLE).mean()),
        given_up=int((~walk.reached).sum()),
    )


@dataclass(frozen=True)
class WalkStudy:
    """Walks on one hill with one integrator or with both.

    Attributes:
        walks: the first is the one that the fits are of.
        summaries: of each.
        fits: of all families, the best first; none if none were asked for, if an episode was given up, or
            if all are of one length.
    """

    walks: tuple[RandomWalk, ...]
    summaries: tuple[Summary, ...]
    fits: tuple[Fit, ...]

    @property
    def on_the_papers_hill(self) -> bool:
        """Whether it is the paper's hill, whatever the integrator."""
        return self.walks[0].hill._replace(integrator=Integrator.SEMI_IMPLICIT) == Hill()

    @property
    def verdicts(self) -> list[str]:
        """What follows, a sentence or two each."""
        claims = [
            _given_up(walk, summary) for walk, summary in zip(self.walks, self.summaries) if summary.given_up
        ]
        if self.on_the_papers_hill:
            claims += [_integrator(walk, summary) for walk, summary in zip(self.walks, self.summaries)]
        return claims + ([_distribution(self.fits)] if self.fits else [])

    def to_dict(self) -> dict[str, Any]:
        """Plain values: those of the first walk, then what was made of them."""
        return {
            **self.walks[0].to_dict(),
            "summaries": {
                walk.hill.integrator.label: asdict(summary)
                for walk, summary in zip(self.walks, self.summaries)
            },
            "fits": [fit.to_dict() for fit in self.fits],
            "verdicts": self.verdicts,
        }


def study(walks: Sequence[RandomWalk], bootstraps: int = BOOTSTRAPS, n_jobs: int = 1) -> WalkStudy:
    """Summaries of the walks, and fits to the lengths of the first.

    Args:
        walks: at least one, with at least one finished episode each.
        bootstraps: samples for each p-value; for 0 nothing is fitted.
        n_jobs: workers, as joblib counts them; they change no bit.
    """
    first = walks[0]
    fits: Sequence[Fit] = ()
    if bootstraps and first.reached.all() and first.lengths.min() < first.lengths.max():
        fits = fit_all(first.lengths, first.seed, bootstraps, n_jobs)
    return WalkStudy(tuple(walks), tuple(map(summarize, walks)), tuple(fits))


def _given_up(walk: RandomWalk, summary: Summary) -> str:
    every = summary.given_up == summary.episodes
    how_many = f"all {summary.episodes:,}" if every else f"{summary.given_up:,} of {summary.episodes:,}"
    return (
        f"{walk.hill.integrator.label}: {'the goal was never reached; ' if every else ''}{how_many} episodes "
        f"were given up at the limit of {walk.max_steps:,} steps, so no distribution is fitted."
    )


def _integrator(walk: RandomWalk, summary: Summary) -> str:
    error = math.hypot(summary.standard_error, PAPER.standard_error)
    away = abs(summary.mean - PAPER.mean) / error
    label = walk.hill.integrator.label
    if walk.hill.integrator == Integrator.EXPLICIT:
        label += ", Eq. (6) as printed"
    return (
        f"{label}: the mean is {away:.1f} standard errors from the paper's; "
        f"the paper's walks {'were not' if away > _FAR else 'may have been'} made so."
    )


def _distribution(fits: Sequence[Fit]) -> str:
    suggested = next(fit for fit in fits if fit.family.name == "log-normal")
    best = fits[0]
    if suggested.p_value >= LEVEL:
        return f"The lengths may be log-normal, as the paper suggests: p = {suggested.p_value:.2g}."
    others = f"the {best.family.name} fits best (AIC less by {suggested.aic - best.aic:.0f})"
    if best is suggested:
        others = "though no other of these fits better"
    elif best.p_value < LEVEL:
        others += f", but not well either (p = {best.p_value:.2g})"
    return f"Log-normal, as the paper suggests, is rejected (p = {suggested.p_value:.2g}); {others}."
