"""The page in a browser: headless Chromium, driven by Playwright. Skipped where there is none."""

import shutil
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest
from page_tournament import HOSTILE, hostile_results

from arena import load
from arena.report.page import write_report

playwright = pytest.importorskip("playwright.sync_api", reason="playwright is not installed")
axe = pytest.importorskip("axe_playwright_python.sync_playwright", reason="axe is not installed")
CHROMIUM = next(filter(None, map(shutil.which, ("chromium", "chromium-browser", "google-chrome"))), None)
pytestmark = [
    pytest.mark.browser,
    pytest.mark.skipif(CHROMIUM is None, reason="there is no chromium on the path"),
]
ENTRANT, STEPS = 1, 3  # columns


@pytest.fixture(scope="module")
def page_file(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("page")
    with load(hostile_results(folder / "race.sqlite")) as results:
        write_report(results, folder / "race.html")
    return folder / "race.html"


@pytest.fixture(scope="module")
def browser() -> Iterator[Any]:
    with playwright.sync_playwright() as started:
        # Chromium's sandbox needs rights that containers do not have; the page is our own.
        opened = started.chromium.launch(executable_path=CHROMIUM, args=["--no-sandbox"])
        yield opened
        opened.close()


@pytest.fixture(params=[("light", 1280), ("dark", 1280), ("light", 380)], ids=["light", "dark", "narrow"])
def page(request: pytest.FixtureRequest, browser: Any, page_file: Path) -> Iterator[Any]:
    """The page, opened; at the end nothing has been complained of, asked for or alerted."""
    scheme, width = request.param
    context = browser.new_context(viewport={"width": width, "height": 800}, color_scheme=scheme)
    context.set_default_timeout(5000)
    opened, troubles = context.new_page(), []
    opened.on("console", lambda message: troubles.append(message.text))
    opened.on("pageerror", lambda error: troubles.append(str(error)))
    opened.on("dialog", lambda dialog: troubles.append(dialog.message))  # and it hangs
    asked: list[str] = []
    opened.on("request", lambda one: asked.append(one.url))
    opened.goto(page_file.as_uri())
    yield opened
    assert troubles == []
    assert [url for url in asked if not url.startswith("data:")] == [page_file.as_uri()]
    context.close()


def column(page: Any, number: int) -> list[str]:
    """The visible texts of a column of the leaderboard."""
    cells = page.locator(f"#board tbody tr:visible > :nth-child({number + 1})")
    return [text.strip() for text in cells.all_inner_texts()]


def test_the_leaderboard_is_sorted_and_filtered(page: Any) -> None:
    everyone = column(page, ENTRANT)
    assert HOSTILE in everyone
    head = page.locator("#board thead th").nth(STEPS)
    for press, order in (("Enter", "ascending"), ("Space", "descending")):
        head.get_by_role("button").press(press)
        assert head.get_attribute("aria-sort") == order
        values = [float(text.split()[0]) for text in column(page, STEPS)]
        assert values == sorted(values, reverse=order == "descending")
    assert values[0] != values[-1]
    page.locator("#filter").fill("MOMENT")
    assert len(column(page, ENTRANT)) == 2  # one by its name, one by its agent's
    page.locator("#filter").fill("")
    assert sorted(column(page, ENTRANT)) == sorted(everyone)


def test_ties_are_told(page: Any) -> None:
    page.locator("#board tbody").get_by_role("button", name="momentum", exact=True).click()
    told = page.locator("#ties").inner_text()
    assert told.startswith("momentum cannot be told apart from: ")
    assert told.count(",") == 4  # two replicates tell nobody apart
    assert page.locator("#board tr.tied").count() == 5


def test_maps_curves_and_pairs_follow_their_choosers(page: Any) -> None:
    def picture(name: str) -> str:
        return str(page.evaluate("name => document.getElementById(name).toDataURL()", name))

    page.locator("#mapped").select_option(label="sarsa")
    before = picture("map")
    page.locator("#mapped").select_option(label=HOSTILE)
    assert page.locator("#map").get_attribute("aria-label").startswith(f"{HOSTILE}: policy, 25 cells")
    policy = picture("map")
    page.locator("#layer").select_option(label="visits, all actions")
    assert len({before, policy, picture("map")}) == 3
    page.locator("#mapped").select_option(label="momentum")
    assert page.locator("#map-told").inner_text() == "momentum counts no visits of the cells of a grid."
    before = picture("curves")
    page.locator("#learners").select_option(label=["random"])
    assert picture("curves") != before
    assert page.locator("#curves-legend").inner_text().strip() == "random"
    page.locator("#row").select_option(label="momentum")
    page.locator("#column").select_option(label="random")
    assert "A run of momentum is better than one of random:" in page.locator("#pair-told").inner_text()


def test_the_race_is_driven(page: Any) -> None:
    page.locator("#cars").select_option(label=["momentum", "sarsa"])
    page.locator("#start").select_option(label="-0.40")
    page.locator("#speed").select_option(label="fast")
    page.get_by_role("button", name="Play").click()
    page.get_by_role("button", name="Pause").wait_for()
    page.wait_for_function("document.getElementById('race-step').textContent.match(/Step [1-9]/)")
    page.get_by_role("button", name="Pause").click()
    page.locator("#scrubber").fill("90")
    told = page.locator("#race-told").inner_text()
    assert "momentum: under way" in told
    assert "optimal drive: goal in 83 steps" in told
    page.locator("#scrubber").press("End")
    assert "momentum: goal in" in page.locator("#race-told").inner_text()
    assert page.locator("#race-told li").count() == 3


def test_nothing_is_wider_than_the_window(page: Any) -> None:
    assert page.evaluate("document.documentElement.scrollWidth <= window.innerWidth")


def test_axe_finds_no_violation(page: Any) -> None:
    found = axe.Axe().run(page)
    assert found.violations_count == 0, found.generate_report()
