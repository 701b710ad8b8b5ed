"""The contract suite: what every agent must hold to, in the manner of scikit-learn's ``check_estimator``.

In the tests of a plugin::

    from arena.testing import parametrize_with_checks

    @parametrize_with_checks([Entrant("mine", MyAgent), Entrant("mine, fine", MyAgent, bins=(40, 40))])
    def test_contract(entrant, check):
        check(entrant)
"""

import itertools
from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from arena.testing.checks import CHECKS, Check, NotApplicableError
from arena.tournament.entrant import Entrant

if TYPE_CHECKING:
    import pytest


@dataclass(frozen=True)
class Finding:
    """What one check found.

    Attributes:
        check: what was checked, in words.
        status: ``"ok"``, ``"failed"`` or ``"skipped"``.
        reason: why, if it is not ok.
    """

    check: str
    status: str
    reason: str = ""


def findings(entrant: Entrant) -> Iterator[Finding]:
    """What each check of the contract finds."""
    for check in CHECKS:
        name = check.__name__.removeprefix("check_").replace("_", " ")
        try:
            check(entrant)
        except NotApplicableError as reason:
            yield Finding(name, "skipped", str(reason))
        except KeyboardInterrupt:
            raise
        except BaseException as error:  # whatever the agent raises
            message = str(error) if isinstance(error, AssertionError) else f"{type(error).__name__}: {error}"
            yield Finding(name, "failed", message.strip() or type(error).__name__)
        else:
            yield Finding(name, "ok")


def check_agent(agent: type[Any], **parameters: Any) -> None:
    """Check that a class is a good agent, as scikit-learn's ``check_estimator`` does.

    Args:
        agent: the class.
        parameters: of the agent.

    Raises:
        AssertionError: when it breaks the contract; the message says how.
        TypeError, ValueError: when it lacks a method or a parameter breaks its rule.
    """
    entrant = Entrant(agent.__name__, agent, **parameters)
    for finding in findings(entrant):
        if finding.status == "failed":
            raise AssertionError(f"{agent.__name__}: {finding.check}: {finding.reason}")


def parametrize_with_checks(entrants: Iterable[Entrant]) -> "pytest.MarkDecorator":
    """Decorator of a pytest test with the arguments ``entrant`` and ``check``."""
    import pytest

    def skipping(check: Check) -> Check:
        def checked(entrant: Entrant) -> None:
            try:
                check(entrant)
            except NotApplicableError as reason:
                pytest.skip(str(reason))

        return checked

    pairs = [
        pytest.param(entrant, skipping(check), id=f"{entrant.name}-{check.__name__.removeprefix('check_')}")
        for entrant, check in itertools.product(entrants, CHECKS)
    ]
    return pytest.mark.parametrize(("entrant", "check"), pairs)
