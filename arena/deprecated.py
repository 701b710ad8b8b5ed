"""Modules of 0.1 under their names of then: until 0.3 they hand on, with a warning, what has moved.

They are those that the documentation or a page of results told people to import.
"""

import sys
import warnings
from collections.abc import Sequence
from importlib.machinery import ModuleSpec
from pkgutil import resolve_name
from types import ModuleType

MOVED = {
    "arena.configuration": ("arena.tournament", ("from_dict", "load_tournament")),
    "arena.curves": ("arena.analysis", ("area", "learning_curves", "moving_average", "settled")),
    "arena.figures_policy": ("arena.figures", ("draw_phase", "draw_policy", "draw_value", "draw_visits")),
    "arena.leaderboard": ("arena.analysis", ("Leaderboard", "Standing", "leaderboard")),
    "arena.pairs": ("arena.analysis", ("compare_entrants", "regressions")),
    "arena.trained": ("arena.results", ("Results.trained", "Trained", "UnknownPolicyError")),
}
"""The package where the names of a module are now, and how they are called there."""


class _Moved:
    """Finds and loads them; their files are gone."""

    def find_spec(
        self, fullname: str, path: Sequence[str] | None, target: ModuleType | None = None
    ) -> ModuleSpec | None:
        if fullname not in MOVED:
            return None
        return ModuleSpec(fullname, self)  # type: ignore[arg-type]  # a loader by its methods

    def create_module(self, spec: ModuleSpec) -> ModuleType | None:
        return None  # as always

    def exec_module(self, module: ModuleType) -> None:
        package, names = MOVED[module.__name__]
        warnings.warn(
            f"{module.__name__} goes in version 0.3; its names are in {package}: {', '.join(names)}",
            DeprecationWarning,
            stacklevel=2,  # where it is imported: the frames between are the import's own
        )
        for name in names:
            setattr(module, name.rpartition(".")[2], resolve_name(f"{package}:{name}"))


def install() -> None:
    """Let them be imported."""
    sys.meta_path.append(_Moved())
