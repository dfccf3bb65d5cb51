"""Makes the section with the scores of scenarios: for each a table of its parameters, coloured by the
classes of Euro NCAP."""

from collections.abc import Iterator

from roadgpt.brief.scenarios import CLASSES, Scenario, scenario
from roadgpt.campaign.record import Record, reading_store
from roadgpt.errors import UsageError
from roadgpt.reading import json_of
from roadgpt.report.chapters.wording import row
from roadgpt.report.page.model import Block, Section, Table, TableCell, cell
from roadgpt.report.road_record import file_of

TESTS = (
    "SELECT cell, number, origin, outcome, cause, beyond, features FROM tests LEFT JOIN details "
    "USING (cell, number) WHERE outcome IS NOT NULL ORDER BY cell, number"
)


def score(record: Record) -> Section | None:
    """Returns the section; None if no scenarios of the catalogue were tested."""
    cells = {each.name: each for each in record.cells()}
    found = dict[tuple[str, str], list[tuple[Scenario, TableCell]]]()
    with reading_store(record.path):
        for name, number, origin, outcome, cause, beyond, features in record.stream(TESTS):
            try:
                one = scenario(cells[name].scenario_of(origin))
            except UsageError:  # none, or one that the catalogue had before
                continue
            numbers = json_of(features) if features else {}
            href = file_of(record.folder, name, number)
            its = found.setdefault((name, one.name), [])
            its.append((one, _rated(one, outcome, cause, beyond, numbers, href)))
    if not found:
        return None
    driver = {name: each.request.setup.driver for name, each in cells.items()}
    classes = dict.fromkeys(points[0][0].judged for points in found.values())
    blocks: list[Block] = [
        f"{each.capitalize()}: {CLASSES[each].says} ({CLASSES[each].source})." for each in classes
    ]
    blocks.append(
        "Grey: refused, or not tested. Numbers are km/h at a contact, or m to the edge of the lane."
    )
    blocks += [_table(points, f"{name}, {driver[of]}") for (of, name), points in found.items()]
    return Section("Score", blocks)


def _rated(
    one: Scenario, outcome: str, cause: str | None, beyond: float | None, numbers: dict[str, float], href: str
) -> TableCell:
    """Returns how one test ended; a failure that is no contact is red, whatever the class says."""
    if outcome in ("INVALID", "ERROR", "NOT TESTED", "VALID"):
        return cell(outcome.lower(), href=href, colour="grey")
    colour, text = one.rated(numbers.get("IMPACT"), -numbers.get("DTLE", -(beyond or 0.0)))
    if outcome == "FAIL" and colour == "green":
        colour, text = "red", cause or "failed"
    return cell(text, f"{colour[0].upper()} {text}", href, colour)


def _table(points: list[tuple[Scenario, TableCell]], caption: str) -> Table:
    """Returns the tests of a scenario: in columns by the last of the parameters that differ, in rows by the
    others."""
    one = points[0][0]
    differ = list[str]()
    for name in one.values:  # not those that follow from the ones before
        known = {tuple(each.values[of] for of in differ) for each, _ in points}
        if len({tuple(each.values[of] for of in (*differ, name)) for each, _ in points}) > len(known):
            differ.append(name)
    down, across = (differ[:-1] or ["ego"], differ[-1]) if {*differ} - {"ego"} else (["ego"], "")
    columns = [*dict.fromkeys(each.values.get(across, "") for each, _ in points)]
    rows = dict[tuple[object, ...], dict[object, TableCell]]()
    for each, shown in points:
        rows.setdefault(tuple(each.values[name] for name in down), {})[each.values.get(across, "")] = shown
    heads = [*down, *(f"{across} {_said(value)}".strip() or "score" for value in columns)]
    body = [
        row(*map(_said, key), *(its.get(value, cell(None)) for value in columns)) for key, its in rows.items()
    ]
    return Table(one.name.replace(":", "-").replace("_", "-"), caption, heads, body, one.says)


def _said(value: object) -> str:
    return f"{value:g}" if isinstance(value, float) else str(value)


def lines(section: Section) -> Iterator[list[tuple[str, str]]]:
    """Yields the lines of the section as pieces of text, each with its colour."""
    for block in section.blocks:
        if not isinstance(block, Table):
            yield [(str(block), "")]
            continue
        texts = [[each.text for each in its] for its in block.rows]
        wide = [max(map(len, column)) for column in zip(block.heads, *texts, strict=True)]
        yield [("", "")]
        yield [(f"{block.caption}: {block.note}", "")]
        yield [(f" {head:<{n}} ", "") for head, n in zip(block.heads, wide, strict=True)]
        for its in block.rows:
            yield [(f" {each.text:<{n}} ", each.colour) for each, n in zip(its, wide, strict=True)]
