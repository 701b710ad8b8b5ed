"""Agents and their parts: discretizations, schedules, one algorithm a file."""

from agents.contract import Agent, Task
from agents.exploration import Softmax, UpperConfidence
from agents.grid import Grid
from agents.q_learning import QLearning
from agents.references import MomentumAgent, RandomAgent
from agents.registry import agent_class, agent_name, register
from agents.sarsa import Sarsa
from agents.schedules import HarmonicRate, LinearDecay

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
