"""The commands about agents: ``arena agents``, ``arena new-agent``, ``arena check``."""

import inspect
import json
import sys
from pathlib import Path
from typing import Annotated, Any

import typer
from rich.console import Console
from rich.padding import Padding
from rich.text import Text

from agents.parameters.declared import parameters_of
from agents.registry import Registered, agent_class, all_agents
from arena.cli.options import Plugins, load_plugins
from arena.common.plain import plain
from arena.plugins.loading import PluginError, load_plugin
from arena.tournament.entrant import Entrant

FAILED = 1


def agents(
    name: Annotated[str | None, typer.Argument(help="Tell all about one agent.", metavar="NAME")] = None,
    plugin: Plugins = None,
    as_json: Annotated[bool, typer.Option("--json", help="Print one JSON object.")] = False,
) -> None:
    """List the agents there are: their parameters with bounds, source and origin."""
    for path in plugin or ():
        try:
            load_plugin(path)
        except PluginError as error:  # the others are still there
            print(f"arena: {error}", file=sys.stderr)
    if name is not None:
        agent_class(name)  # tells the nearest name if there is none
    known, broken = all_agents()
    for line in broken:
        print(f"arena: {line}", file=sys.stderr)
    chosen = [known[name]] if name is not None else sorted(known.values(), key=lambda entry: entry.name)
    if as_json:
        print(json.dumps({entry.name: _told(entry) for entry in chosen}))
    elif name is not None:
        _print_agent(chosen[0])
    else:
        _print_list(chosen)


def new_agent(
    name: Annotated[str, typer.Argument(help="Such as my-agent.", metavar="NAME")],
    folder: Annotated[Path, typer.Option(help="Where to write it.", metavar="FOLDER")] = Path(),
) -> None:
    """Write an agent that runs at once, commented, and its test."""
    from arena.plugins.template import write

    agent, test = write(name, folder)
    print(f"wrote {agent} and {test}; next: arena check {agent}")


def check(
    target: Annotated[
        str, typer.Argument(help="A Python file with agents, or an agent's name.", metavar="FILE|NAME")
    ],
    plugin: Plugins = None,
    as_json: Annotated[bool, typer.Option("--json", help="Print one JSON object.")] = False,
) -> None:
    """Check that agents hold to the contract; exit with 1 if one does not."""
    load_plugins(plugin)
    found = load_plugin(target) if target.endswith(".py") else {target: agent_class(target)}
    reports = [_report(Entrant(name, agent)) for name, agent in found.items()]
    if as_json:
        print(json.dumps(reports))
    else:
        for report in reports:
            _print_report(report)
    if any(one["status"] == "failed" for report in reports for one in report["checks"]):
        raise typer.Exit(FAILED)


def _told(entry: Registered) -> dict[str, Any]:
    declared, free = parameters_of(entry.agent)
    return {
        "origin": entry.origin,
        "summary": _summary(entry.agent),
        "source": _source(entry.agent),
        "compiles": hasattr(entry.agent, "_fields"),
        "other_parameters": free,
        "parameters": {
            one.name: {
                "rule": one.rule(),
                "required": one.required,
                **({} if one.required else {"default": plain(one.default)}),
            }
            for one in declared.values()
        },
    }


def _summary(agent: type[Any]) -> str:
    """The first line of the class's own documentation."""
    return (vars(agent).get("__doc__") or "").strip().partition("\n")[0]


def _source(agent: type[Any]) -> str:
    """The class's own ``citation``, else what its module says first: where the algorithm comes from."""
    citation = vars(agent).get("citation")
    if isinstance(citation, str):
        return citation
    return (inspect.getdoc(sys.modules.get(agent.__module__)) or "").partition("\n")[0]


def _print_list(entries: list[Registered]) -> None:
    console = Console(highlight=False, soft_wrap=True)
    for entry in entries:
        told = _told(entry)
        console.print(Text(entry.name, style="bold") + Text(f": {entry.origin}, {_how(told)}"))
        console.print(Text(f"  {told['source'] or told['summary']}"))
        given = [_with_default(name, one) for name, one in told["parameters"].items()]
        console.print(Padding(Text(", ".join(given) or "no parameters"), (0, 0, 1, 4)), soft_wrap=False)
    console.print("arena agents NAME tells all about one, with the bounds of its parameters.")


def _how(told: dict[str, Any]) -> str:
    return "compiled" if told["compiles"] else "interpreted"


def _with_default(name: str, one: dict[str, Any]) -> str:
    return name if one["required"] else f"{name} = {_compact(one['default'])}"


def _compact(value: Any) -> str:
    return f"{{{_short(value)}}}" if isinstance(value, dict) else _short(value)


def _print_agent(entry: Registered) -> None:
    told = _told(entry)
    console = Console(highlight=False, soft_wrap=True)
    runs = "compiled, if numba can" if told["compiles"] else "interpreted"
    for line in (entry.name, "", inspect.getdoc(entry.agent) or "", "", f"Source: {told['source']}"):
        console.print(Text(line))
    console.print(Text(f"Origin: {entry.origin}; runs {runs}.\n"))
    for name, one in told["parameters"].items():
        default = "must be given" if one["required"] else f"default {_short(one['default'])}"
        console.print(Text(f"  {name}: {one['rule']}; {default}"))
    create = inspect.getdoc(getattr(entry.agent, "create", None)) or ""
    if create:
        console.print(Text(f"\n{create}"))


def _short(value: Any) -> str:
    return ", ".join(f"{k} = {v}" for k, v in value.items()) if isinstance(value, dict) else repr(value)


def _report(entrant: Entrant) -> dict[str, Any]:
    from arena.testing.suite import findings
    from arena.testing.timing import seconds_per_step

    checks = [{"check": f.check, "status": f.status, "reason": f.reason} for f in findings(entrant)]
    report: dict[str, Any] = {"agent": entrant.name, "checks": checks}
    if all(one["status"] != "failed" for one in checks):
        step, reference = seconds_per_step(entrant)
        report |= {"seconds_per_step": step, "seconds_per_step_of_q_learning": reference}
    return report


def _print_report(report: dict[str, Any]) -> None:
    console = Console(highlight=False, soft_wrap=True)
    console.print(Text(report["agent"], style="bold"))
    styles = {"ok": "green", "failed": "bold red", "skipped": "yellow"}
    for one in report["checks"]:
        reason = f": {one['reason']}" if one["reason"] else ""
        console.print(
            Text(f"  {one['status']:8}", styles[one["status"]]) + Text(f"{one['check']}{reason}", "default")
        )
    if "seconds_per_step" in report:
        step, reference = report["seconds_per_step"], report["seconds_per_step_of_q_learning"]
        console.print(f"  {step * 1e9:.0f} ns a step, {step / reference:.2f} times the built-in Q-learning")


def add_commands(app: typer.Typer) -> None:
    """Make them commands of ``app``."""
    app.command()(agents)
    app.command("new-agent")(new_agent)
    app.command()(check)
