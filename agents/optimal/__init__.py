"""The fewest steps to the goal, with a certificate; and a driver that needs hardly more."""

from agents.optimal.driver import Optimal
from agents.optimal.fewest_steps import NEVER, optimal_steps

__all__ = ["NEVER", "Optimal", "optimal_steps"]
