"""Parameters of agents: declared once, with types, bounds and defaults."""

from agents.parameters.declared import (
    Count,
    NonNegative,
    Parameter,
    Positive,
    Probability,
    StepSize,
    parameters_of,
    settle_all,
)
from agents.parameters.validation import extends, inherits, validated

__all__ = [
    "Count",
    "NonNegative",
    "Parameter",
    "Positive",
    "Probability",
    "StepSize",
    "extends",
    "inherits",
    "parameters_of",
    "settle_all",
    "validated",
]
