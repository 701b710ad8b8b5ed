"""What ``arena compare`` prints."""

from collections.abc import Sequence

from rich.text import Text

from arena.analysis.pairwise import Comparison, Regression
from arena.analysis.scores import SCORES


def comparison_text(comparison: Comparison) -> Text:
    """Return two entrants side by side: an estimate a line, with its interval, then the test."""
    a, b, score = comparison.a, comparison.b, SCORES[comparison.by]
    rows = [
        (f"{a}, mean", comparison.means[0], score.decimals),
        (f"{b}, mean", comparison.means[1], score.decimals),
        (f"{a}, interquartile mean", comparison.interquartile[0], score.decimals),
        (f"{b}, interquartile mean", comparison.interquartile[1], score.decimals),
        ("difference of the means", comparison.difference, score.decimals),
        (f"probability that {a} is better", comparison.probability, 2),
    ]
    lines = [f"{a} and {b} by {score.description}: {comparison.replicates} replicates."]
    width = max(len(label) for label, *_ in rows)
    for label, estimate, digits in rows:
        value, low, high = (f"{number:,.{digits}f}" for number in estimate)
        lines.append(f"  {label:{width}}  {value:>9}  [{low}, {high}]")
    lines.append(f"Paired permutation test: p = {comparison.p_value:.2g}. {comparison.verdict}")
    return Text("\n".join(lines))


def changes_text(
    changes: Sequence[Regression], by: str, only_new: Sequence[str], only_old: Sequence[str]
) -> Text:
    """Return a line for each entrant of two files, and who is in one of them only."""
    digits = SCORES[by].decimals
    width = max(len(change.entrant) for change in changes)
    lines = []
    for change in changes:
        verdict = "worse beyond chance" if change.regressed else "ok"
        interval = f"[{change.worse.low:+,.{digits}f}, {change.worse.high:+,.{digits}f}]"
        lines.append(
            f"{change.entrant:{width}}  {change.before:,.{digits}f} -> {change.after:,.{digits}f}, worse by "
            f"{change.worse.value:+,.{digits}f} {interval}, p = {change.p_value:.2g}: {verdict}"
        )
    for file, names in (("the baseline", only_old), ("the new file", only_new)):
        if names:
            lines.append(f"Only in {file}: {', '.join(names)}.")
    return Text("\n".join(lines))
