"""Agents and their parts: discretizations, schedules, one algorithm a file."""

from agents.algorithms.q_learning import QLearning
from agents.algorithms.sarsa import Sarsa
from agents.baselines import MomentumAgent, RandomAgent
from agents.contract import Agent, Task
from agents.discretization.grid import Grid
from agents.learning.exploration import Softmax, UpperConfidence
from agents.learning.schedules import HarmonicRate, LinearDecay
from agents.registry import agent_class, agent_name, register

__all__ = [
    "Agent",
    "Grid",
    "HarmonicRate",
    "LinearDecay",
    "MomentumAgent",
    "QLearning",
    "RandomAgent",
    "Sarsa",
    "Softmax",
    "Task",
    "UpperConfidence",
    "agent_class",
    "agent_name",
    "register",
]
