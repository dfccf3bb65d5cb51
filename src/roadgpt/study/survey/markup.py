"""Makes HTML out of templates: every value is escaped, unless it is Markup already."""

import html


class Markup(str):
    """Text that is HTML, and stands as it is."""

    __slots__ = ()


def fill(template: str, **values: object) -> Markup:
    """A template with its ``{names}`` filled in; nothing of a value is taken for markup or for a name.

    Args:
        template: HTML of ours, never of anybody else.
        values: Markup stands as it is, None and False as nothing; all else is escaped, quotation marks too.
    """
    return Markup(template.format_map({name: _told(value) for name, value in values.items()}))


def joined(parts: list[Markup]) -> Markup:
    """Pieces of HTML one after the other."""
    return Markup("\n".join(parts))


def _told(value: object) -> str:
    if isinstance(value, Markup):
        return value
    if value is None or value is False:
        return ""
    return html.escape(str(value), quote=True)


def paragraphs(text: str) -> Markup:
    """Text of several paragraphs, which are parted by empty lines."""
    parts = [part.strip() for part in text.replace("\r\n", "\n").split("\n\n") if part.strip()]
    return joined([fill("<p>{part}</p>", part=part) for part in parts])
