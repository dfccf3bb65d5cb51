"""Writes SVG elements for small pictures; a page may contain hundreds of such pictures.

Charts with axes are drawn by matplotlib (``page.chart``). For a gallery of a hundred linked roads, matplotlib
would take 1.6 s and write 1.8 times the bytes, without the titles that appear when the pointer is on a road.
"""

from html import escape

NARROW = 384.0  # px; a chart that is meant to be narrower is not widened on any screen


def tag(name: str, content: str = "", /, **attributes: object) -> str:
    """Returns an element; ``_`` in an attribute's name stands for ``-``, and ``class_`` is ``class``."""
    given = ""
    for key, value in attributes.items():
        text = number(value) if isinstance(value, float) else str(value)
        given += f' {key.rstrip("_").replace("_", "-")}="{escape(text)}"'
    return f"<{name}{given}>{content}</{name}>" if content else f"<{name}{given}/>"


def number(value: float) -> str:
    """Returns a number with at most two decimals, and no trailing zeros."""
    text = f"{value:.2f}".rstrip("0").rstrip(".")
    return "0" if text == "-0" else text


def words(x: float, y: float, text: str, size: float, is_soft: bool = False) -> str:
    """Returns a text element that begins at (x, y)."""
    style = {"class_": "soft"} if is_soft else {}
    return tag("text", escape(text), x=x, y=y, font_size=size, **style)


def chart(width: float, height: float, content: str, label: str) -> str:
    """Returns an ``svg`` element of ``width`` by ``height`` px; ``label`` is for screen readers."""
    return tag(
        "svg",
        content,
        xmlns="http://www.w3.org/2000/svg",
        viewBox=f"0 0 {number(width)} {number(height)}",
        width=width,
        height=height,
        class_="chart" if width >= NARROW else "chart narrow",
        role="img",
        aria_label=label,
    )
