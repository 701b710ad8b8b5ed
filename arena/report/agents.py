"""What ``arena agents`` and ``arena check`` print."""

import inspect
import sys
from collections.abc import Iterable
from typing import Any

from rich.console import Console
from rich.padding import Padding
from rich.text import Text

from agents.parameters.declared import parameters_of
from agents.registry import Registered
from arena.common.plain import plain


def description(entry: Registered) -> dict[str, Any]:
    """Return all that is known of an agent, as plain values."""
    declared, free = parameters_of(entry.agent)
    return {
        "origin": entry.origin,
        "summary": _summary(entry.agent),
        "source": _source(entry.agent),
        "compiles": hasattr(entry.agent, "_fields"),
        "other_parameters": free,
        "parameters": {
            parameter.name: {
                "rule": parameter.rule(),
                "required": parameter.required,
                **({} if parameter.required else {"default": plain(parameter.default)}),
            }
            for parameter in declared.values()
        },
    }


def print_list(terminal: Console, entries: Iterable[Registered]) -> None:
    """Print a paragraph an agent."""
    for entry in entries:
        agent = description(entry)
        how = "compiled" if agent["compiles"] else "interpreted"
        terminal.print(Text(entry.name, style="bold") + Text(f": {entry.origin}, {how}"))
        terminal.print(Text(f"  {agent['source'] or agent['summary']}"))
        parameters = [_with_default(name, parameter) for name, parameter in agent["parameters"].items()]
        text = ", ".join(parameters) or "no parameters"
        terminal.print(Padding(Text(text), (0, 0, 1, 4)), soft_wrap=False)
    terminal.print("arena agents NAME tells all about one, with the bounds of its parameters.")


def print_agent(terminal: Console, entry: Registered) -> None:
    """Print all about one."""
    agent = description(entry)
    how = "compiled, if numba can" if agent["compiles"] else "interpreted"
    for line in (entry.name, "", inspect.getdoc(entry.agent) or "", "", f"Source: {agent['source']}"):
        terminal.print(Text(line))
    terminal.print(Text(f"Origin: {entry.origin}; runs {how}.\n"))
    for name, parameter in agent["parameters"].items():
        default = "must be given" if parameter["required"] else f"default {_short(parameter['default'])}"
        terminal.print(Text(f"  {name}: {parameter['rule']}; {default}"))
    create = inspect.getdoc(getattr(entry.agent, "create", None)) or ""
    if create:
        terminal.print(Text(f"\n{create}"))


def print_checks(terminal: Console, report: dict[str, Any]) -> None:
    """Print what ``arena check --json`` says of one agent."""
    terminal.print(Text(report["agent"], style="bold"))
    styles = {"ok": "green", "failed": "bold red", "skipped": "yellow"}
    for check in report["checks"]:
        reason = f": {check['reason']}" if check["reason"] else ""
        status = Text(f"  {check['status']:8}", styles[check["status"]])
        terminal.print(status + Text(f"{check['check']}{reason}", "default"))
    if "seconds_per_step" in report:
        step, reference = report["seconds_per_step"], report["seconds_per_step_of_q_learning"]
        terminal.print(f"  {step * 1e9:.0f} ns a step, {step / reference:.2f} times the built-in Q-learning")


def _summary(agent: type[Any]) -> str:
    """The first line of the class's own documentation."""
    return (vars(agent).get("__doc__") or "").strip().partition("\n")[0]


def _source(agent: type[Any]) -> str:
    """The class's own ``citation``, else what its module says first: where the algorithm comes from."""
    citation = vars(agent).get("citation")
    if isinstance(citation, str):
        return citation
    return (inspect.getdoc(sys.modules.get(agent.__module__)) or "").partition("\n")[0]


def _with_default(name: str, parameter: dict[str, Any]) -> str:
    return name if parameter["required"] else f"{name} = {_compact(parameter['default'])}"


def _compact(value: Any) -> str:
    return f"{{{_short(value)}}}" if isinstance(value, dict) else _short(value)


def _short(value: Any) -> str:
    return ", ".join(f"{k} = {v}" for k, v in value.items()) if isinstance(value, dict) else repr(value)
