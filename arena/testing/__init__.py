"""The contract suite: what every agent must hold to."""

from arena.testing.suite import Finding, check_agent, findings, parametrize_with_checks

__all__ = ["Finding", "check_agent", "findings", "parametrize_with_checks"]
