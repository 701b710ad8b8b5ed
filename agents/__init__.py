"""Agents and their parts: discretizations, schedules, one algorithm a file."""

from agents.contract import Agent, Task
from agents.grid import Grid
from agents.q_learning import QLearning
from agents.references import MomentumAgent, RandomAgent
from agents.registry import agent_class, agent_name
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
    "Task",
    "agent_class",
    "agent_name",
]
