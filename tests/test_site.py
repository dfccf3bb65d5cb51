"""The documentation as ``make docs`` builds it, opened as files by a browser; needs the extra ``docs``."""

from collections.abc import Iterator
from pathlib import Path

import pytest

from chromium import FOUND, BrowserTab, browser

pytest.importorskip("mkdocstrings", reason="the extra docs is not installed")
pytestmark = pytest.mark.skipif(FOUND is None, reason="there is no chromium")

ROOT = Path(__file__).parents[1]
QUERY = "document.querySelector('[data-md-component=search-query]')"
WIDER = "[...document.querySelectorAll('pre > code')].filter(code => code.scrollWidth > code.clientWidth + 1)"


@pytest.fixture(scope="module")
def site(tmp_path_factory: pytest.TempPathFactory) -> Path:
    from mkdocs.commands.build import build
    from mkdocs.config import load_config

    folder = tmp_path_factory.mktemp("site")
    config = load_config(str(ROOT / "mkdocs.yml"), site_dir=str(folder), strict=True)
    config.plugins.run_event("startup", command="build", dirty=False)
    build(config)
    config.plugins.run_event("shutdown")
    return folder


@pytest.fixture(scope="module")
def tab() -> Iterator[BrowserTab]:
    with browser() as tab:
        tab.size(1280, 900)
        yield tab


def show(tab: BrowserTab, page: Path) -> None:
    tab.asked.clear()
    loads = tab.loads
    tab.send("Page.navigate", url=page.as_uri())
    tab.wait_for("document.readyState === 'complete'")
    assert tab.loads > loads


def test_the_search_finds_a_page_though_the_site_is_a_folder_on_disk(site: Path, tab: BrowserTab) -> None:
    show(tab, site / "how-to" / "film-a-drive.html")
    tab.run(f"{QUERY}.focus(), {QUERY}.value = 'superelevation', 0")
    tab.run(f"{QUERY}.dispatchEvent(new Event('keyup', {{bubbles: true}})), 0")
    tab.wait_for("document.querySelector('.md-search-result__item a')")
    first = tab.run("document.querySelector('.md-search-result__item a').href.split('?')[0]")
    assert first.startswith(site.as_uri())
    assert "superelevation" in Path(first.removeprefix("file://").split("#")[0]).read_text("utf-8").lower()
    assert {address.partition(":")[0] for address in tab.asked} <= {"file", "data"}
    assert tab.told == []


@pytest.mark.parametrize(
    "name", ["index", "house", "how-to/junctions", "reference/commands", "reference/plans"]
)
@pytest.mark.parametrize("wide", [390, 1280])
def test_no_line_of_code_is_cut_off(site: Path, tab: BrowserTab, name: str, wide: int) -> None:
    tab.size(wide, 900)
    show(tab, site / f"{name}.html")
    assert tab.run("document.querySelectorAll('pre > code').length") > 0
    assert tab.run(f"{WIDER}.map(code => code.innerText)") == []
