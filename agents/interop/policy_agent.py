"""A policy from elsewhere as an entrant: it was learned there, drives here, and learns nothing more."""

import hashlib
import inspect
from collections.abc import Callable
from functools import partial
from typing import Any, ClassVar

import numpy as np
from numpy.typing import NDArray

from agents.baselines import DoesNotLearn
from envs import Hill
from envs.foundation.errors import InvalidTypeError, InvalidValueError

_GRID = (40, 25)  # positions and velocities by which a policy is known


class PolicyAgent(DoesNotLearn):
    """Drives as its attribute ``policy`` says: ``Entrant("ppo", PolicyAgent.of(model.predict))``.

    A file has it as a class of its own, ``class Ppo(PolicyAgent): policy = PPO.load("ppo.zip").predict``.

    The policy is called with what Gymnasium's ``MountainCar-v0`` would show, position and velocity,
    float32, shape (2,), and with ``deterministic=True`` if it has an argument of that name. It returns the
    action, an integer of any kind, alone or, as ``predict`` of Stable-Baselines3 does, with None.

    Its only parameter is ``fingerprint``, what the policy is known by. By default it is that of the
    policy; another is refused. So no results file mixes policies that do different things.

    Raises:
        TypeError: when the policy cannot be called.
        ValueError: when what it returns is no action, or not the same each time.
    """

    policy: ClassVar[Callable[..., Any]]

    @staticmethod
    def of(policy: Callable[..., Any]) -> type["PolicyAgent"]:
        """The class of agents that drive as ``policy`` says; raises what a class of one's own would."""
        # Results files know the class by the module that it had in version 0.1.
        namespace = {"__module__": "arena.policy_agent", "policy": staticmethod(policy)}
        return type("PolicyAgent", (PolicyAgent,), namespace)

    def __init_subclass__(cls) -> None:
        if "policy" not in vars(cls):  # a copy in a worker receives it, and ``create``, later
            return
        known = cls().fingerprint()
        if cls().fingerprint(backwards=True) != known:
            raise InvalidValueError(
                "policy must do the same at the same place, got one with chance or a memory"
            )

        def create(kind: type[PolicyAgent], task: Any, *, fingerprint: str = known) -> PolicyAgent:
            agent = kind()
            if fingerprint != agent.fingerprint():
                raise InvalidValueError(
                    f"fingerprint must be that of the policy, {agent.fingerprint()!r}, got {fingerprint!r}"
                )
            return agent

        cls.create = classmethod(create)  # type: ignore[attr-defined]  # its default is the class's own

    def __init__(self) -> None:
        policy = getattr(self, "policy", None)
        if not callable(policy):
            raise InvalidTypeError(f"policy must be callable, such as model.predict, got {policy!r}")
        self._ask = partial(policy, deterministic=True) if _can_be_deterministic(policy) else policy

    def greedy(self, observation: Any) -> int:
        """The action of the policy.

        Raises:
            ValueError: when it is none.
        """
        return _action(self._ask(np.array(observation, np.float32)))

    def fingerprint(self, *, backwards: bool = False) -> str:
        """A digest of what the policy does at 1,000 places all over the hill.

        Where it raises it does nothing: the runs say so: they fail.

        Args:
            backwards: ask for the places from the last to the first; no matter to a policy without memory.
        """
        places = [np.linspace(low, high, n) for low, high, n in zip(Hill().low, Hill().high, _GRID)]
        observations = np.stack(np.meshgrid(*places), -1).reshape(-1, 2).astype(np.float32)
        order = -1 if backwards else 1
        actions = [self._tried(observation) for observation in observations[::order]][::order]
        return hashlib.sha256(repr(actions).encode()).hexdigest()[:12]

    def _tried(self, observation: NDArray[np.float32]) -> int | None:
        try:
            returned = self._ask(observation.copy())
        except Exception:  # of any kind: the policy is anybody's
            return None
        return _action(returned)


def _can_be_deterministic(policy: Callable[..., Any]) -> bool:
    try:
        return "deterministic" in inspect.signature(policy).parameters
    except ValueError:  # not written in Python
        return False


def _action(returned: Any) -> int:
    """The action in what a policy returned.

    Raises:
        ValueError: when it is none, or depends on more than the observation.
    """
    action, state = returned if isinstance(returned, tuple) and len(returned) == 2 else (returned, None)
    if state is not None:
        raise InvalidValueError(f"policy must go by the observation alone, got one with a state: {state!r}")
    array = np.asarray(action)
    if array.size != 1 or array.dtype.kind not in "iu":
        raise InvalidValueError(f"policy must return one action, an integer, got {action!r}")
    return int(array.item())
