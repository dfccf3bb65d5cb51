"""Checks numbers that are exported, and writes XML as text, with attributes in the given order and numbers
that can be read back exactly."""

import re
from collections.abc import Mapping
from dataclasses import dataclass, field
from functools import lru_cache
from typing import Self

from roadgpt.errors import ExportError
from roadgpt.road.edges import NOT_FINITE

DECLARATION = '<?xml version="1.0" encoding="UTF-8"?>'
_ESCAPES = str.maketrans(
    {"&": "&amp;", "<": "&lt;", ">": "&gt;", '"': "&quot;", "\n": "&#10;", "\t": "&#9;", "\r": "&#13;"}
)
_UNUSUAL = re.compile(r'[^ -~]|[&<>"]').search  # finds characters that may need an escape


Value = str | float | int


def number(value: float) -> str:
    """Returns the shortest decimal that can be read back as the same number.

    Whole numbers below 1e15 are written without a decimal point."""
    text = repr(float(value) + 0.0)  # -0.0 becomes 0.0
    if text[-1] in "fn":  # inf, nan
        raise ExportError(NOT_FINITE)
    return text[:-2] if text[-2:] == ".0" and abs(value) < 1e15 else text


def escaped(text: str) -> str:
    """Returns text with special characters escaped, for use between tags or in an attribute.

    Characters that XML does not allow are removed."""
    if _UNUSUAL(text) is None:
        return text
    return "".join(filter(_is_allowed, text)).translate(_ESCAPES)


def _is_allowed(letter: str) -> bool:
    if letter < " ":
        return letter in "\n\t\r"
    return not "\ud800" <= letter <= "\udfff" and letter not in "\ufffe\uffff"


@dataclass(slots=True)
class XmlElement:
    """One XML element. ``add`` returns the new child, to which further children can be added."""

    name: str
    attributes: Mapping[str, Value] = field(default_factory=dict)
    children: list["XmlElement"] = field(default_factory=list)
    raw: str = ""  # content between the tags, already escaped; ignored if there are children
    is_shared: bool = False
    """Whether the element may be in several places of a document, and so must not be changed any more."""

    def add(self, name: str, attributes: Mapping[str, Value] | None = None, raw: str = "") -> "XmlElement":
        """Adds a child with the given attributes and returns the child."""
        child = XmlElement(name, attributes or {}, raw=raw)
        self.children.append(child)
        return child

    def with_texts(self, **texts: str) -> Self:
        """Appends a child for each name, with a text that is already escaped, and returns this element."""
        return self.extended(*(type(self)(name, raw=text) for name, text in texts.items()))

    def extended(self, *children: Self) -> Self:
        """Appends the given elements as children, and returns this element."""
        self.children.extend(children)
        return self

    def to_text(self) -> str:
        """Returns the XML document with this element as its root, indented by two spaces per level.

        A shared element, such as equal lanes of many roads, is converted to text only once per level."""
        lines = [DECLARATION]
        _write(self, "", lines, {})
        return "\n".join(lines) + "\n"


@lru_cache(maxsize=4096)
def _value(value: Value) -> str:
    return escaped(value) if isinstance(value, str) else number(value)


_Written = dict[tuple[int, str], str]
"""The text of shared elements, by the id of the Python object and the indent."""


def _write(element: XmlElement, indent: str, lines: list[str], written: _Written) -> None:
    name = element.name
    said = "".join([f' {key}="{_value(value)}"' for key, value in element.attributes.items()])
    if element.children:
        lines.append(f"{indent}<{name}{said}>")
        deeper = indent + "  "
        for child in element.children:
            if child.is_shared:
                lines.append(_shared(child, deeper, written))
            else:
                _write(child, deeper, lines, written)
        lines.append(f"{indent}</{name}>")
    else:
        lines.append(f"{indent}<{name}{said}" + (f">{element.raw}</{name}>" if element.raw else "/>"))


def _shared(element: XmlElement, indent: str, written: _Written) -> str:
    key = (id(element), indent)
    if (text := written.get(key)) is None:
        own: list[str] = []
        _write(element, indent, own, written)
        text = written[key] = "\n".join(own)
    return text
