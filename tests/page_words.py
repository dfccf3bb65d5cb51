"""The words of a report, without its pictures, as a reader sees them: headings, points, commands, tables."""

from html.parser import HTMLParser
from pathlib import Path

UNSEEN = ("style", "svg")
BEFORE = {
    "h2": "\n## ",
    "li": "\n- ",
    "p": "\n",
    "tr": "\n",
    "td": " | ",
    "dt": "\n- ",
    "dd": ": ",
    "code": "`",
}


class _Words(HTMLParser):
    def __init__(self) -> None:
        super().__init__()
        self.text, self._unseen = "", 0

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        self._unseen += tag in UNSEEN
        self.text += BEFORE.get(tag, "")

    def handle_endtag(self, tag: str) -> None:
        self._unseen -= tag in UNSEEN
        self.text += {"code": "`", "h2": "\n"}.get(tag, "")

    def handle_data(self, data: str) -> None:
        self.text += "" if self._unseen else data


def words_of(folder: Path | str) -> str:
    """The words of the report in a folder."""
    reader = _Words()
    reader.feed(Path(folder, "report.html").read_text(encoding="utf-8"))
    return reader.text
