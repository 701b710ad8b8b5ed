"""The environments by their names, for ``gymnasium.make`` and ``pettingzoo.make``.

Neither package is imported for that, they take time: each is told when it is imported itself. Nor is
``importlib.abc``, whose classes a finder and a loader need not inherit from: it takes a tenth of what ``arena
--help`` may.
"""

import sys
from collections.abc import Callable, Sequence
from importlib.machinery import ModuleSpec
from importlib.util import find_spec
from types import ModuleType
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from importlib.abc import Loader


def register_with_gymnasium() -> None:
    """``arena/MountainCar-v0``: one car, or a vector of cars."""
    from gymnasium.envs.registration import register, registry

    if "arena/MountainCar-v0" not in registry:
        register(
            id="arena/MountainCar-v0",
            entry_point="envs.single_car_v0:SingleCarEnv",
            vector_entry_point="envs.vector_car_v0:VectorCarEnv",
            max_episode_steps=200,
            reward_threshold=-110.0,
        )


def register_with_pettingzoo() -> None:
    """``arena/mountain_car_v0``, parallel and turn-based."""
    import pettingzoo

    if not hasattr(pettingzoo, "register"):  # before 1.27
        return
    if "arena/mountain_car-v0" not in pettingzoo.parallel_registry:
        pettingzoo.register("parallel", "arena/mountain_car_v0", "envs.mountain_car_v0:parallel_env")
        pettingzoo.register("aec", "arena/mountain_car_v0", "envs.mountain_car_v0:env")


def when_imported(package: str, action: Callable[[], None]) -> None:
    """Call ``action`` now if ``package`` is imported, else as soon as it is."""
    if package in sys.modules:
        action()
    else:
        sys.meta_path.insert(0, _Watcher(package, action))


class _Watcher:
    """Finds one package as it would be found without it, and calls the action after its import."""

    def __init__(self, package: str, action: Callable[[], None]) -> None:
        self.package, self.action = package, action

    def find_spec(
        self, fullname: str, path: Sequence[str] | None, target: ModuleType | None = None
    ) -> ModuleSpec | None:
        if fullname != self.package:
            return None
        sys.meta_path.remove(self)
        spec = find_spec(fullname)
        if spec and spec.loader:
            spec.loader = _Then(spec.loader, self.action)  # type: ignore[assignment]  # by its methods
        return spec


class _Then:
    """Loads as another loader does, then calls the action."""

    def __init__(self, loader: "Loader", action: Callable[[], None]) -> None:
        self.loader, self.action = loader, action

    def create_module(self, spec: ModuleSpec) -> ModuleType | None:
        return self.loader.create_module(spec)

    def exec_module(self, module: ModuleType) -> None:
        if module.__spec__:
            module.__spec__.loader = self.loader  # of whom resources are asked later
        self.loader.exec_module(module)
        self.action()
