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
    validated,
)
from agents.parameters.inheritance import inherits

__all__ = [
    "Count",
    "NonNegative",
    "Parameter",
    "Positive",
    "Probability",
    "StepSize",
    "inherits",
    "parameters_of",
    "settle_all",
    "validated",
]
