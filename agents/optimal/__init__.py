"""The fewest steps to the goal, with a certificate; and a driver that needs hardly more."""

from agents.optimal.driver import Optimal
from agents.optimal.fewest_steps import optimal_steps
from agents.optimal.relaxed_car import NEVER

__all__ = ["NEVER", "Optimal", "optimal_steps"]
