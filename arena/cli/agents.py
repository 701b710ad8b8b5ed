"""The commands about agents: ``arena agents``, ``arena new-agent``, ``arena check``."""

import json
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from arena.cli.console import SOME_FAILED, answer, say, terminal
from arena.cli.options import AsJson, Plugins, load_plugins

if TYPE_CHECKING:
    from arena.tournament.entrant import Entrant


def agents(
    name: Annotated[str | None, typer.Argument(help="Tell all about one agent.", metavar="NAME")] = None,
    plugin: Plugins = None,
    as_json: AsJson = False,
) -> None:
    """List the agents there are: their parameters with bounds, source and origin."""
    from agents.registry import agent_class, all_agents
    from arena.plugins.loading import PluginError, load_plugin
    from arena.report.agents import description, print_agent, print_list

    for path in plugin or ():
        try:
            load_plugin(path)
        except PluginError as error:  # the others are still there
            say(str(error))
    if name is not None:
        agent_class(name)  # tells the nearest name if there is none
    known, broken = all_agents()
    for line in broken:
        say(line)
    chosen = [known[name]] if name is not None else sorted(known.values(), key=lambda entry: entry.name)
    if as_json:
        answer(json.dumps({entry.name: description(entry) for entry in chosen}))
    elif name is not None:
        print_agent(terminal(), chosen[0])
    else:
        print_list(terminal(), chosen)


def new_agent(
    name: Annotated[str, typer.Argument(help="Such as my-agent.", metavar="NAME")],
    folder: Annotated[Path, typer.Option(help="Where to write it.", metavar="FOLDER")] = Path(),
) -> None:
    """Write an agent that runs at once, commented, and its test."""
    from arena.plugins.template import write

    agent, test = write(name, folder)
    answer(f"wrote {agent} and {test}; next: arena check {agent}")


def check(
    target: Annotated[
        str, typer.Argument(help="A Python file with agents, or an agent's name.", metavar="FILE|NAME")
    ],
    plugin: Plugins = None,
    as_json: AsJson = False,
) -> None:
    """Check that agents hold to the contract; exit with 1 if one does not."""
    from agents.registry import agent_class
    from arena.plugins.loading import load_plugin
    from arena.report.agents import print_checks
    from arena.tournament.entrant import Entrant

    load_plugins(plugin)
    chosen = load_plugin(target) if target.endswith(".py") else {target: agent_class(target)}
    reports = [_checked(Entrant(name, agent)) for name, agent in chosen.items()]
    if as_json:
        answer(json.dumps(reports))
    else:
        for report in reports:
            print_checks(terminal(), report)
    if any(check["status"] == "failed" for report in reports for check in report["checks"]):
        raise typer.Exit(SOME_FAILED)


def _checked(entrant: "Entrant") -> dict[str, Any]:
    from arena.testing.suite import findings
    from arena.testing.timing import seconds_per_step

    checks = [{"check": f.check, "status": f.status, "reason": f.reason} for f in findings(entrant)]
    report: dict[str, Any] = {"agent": entrant.name, "checks": checks}
    if all(check["status"] != "failed" for check in checks):
        step, reference = seconds_per_step(entrant)
        report |= {"seconds_per_step": step, "seconds_per_step_of_q_learning": reference}
    return report


def add_commands(app: typer.Typer) -> None:
    """Make them commands of ``app``."""
    app.command()(agents)
    app.command("new-agent")(new_agent)
    app.command()(check)
