"""What raters look at: the description, plots, films and the 3-D view of one road or of two."""

from roadgpt.study.survey.markup import Markup, fill, joined
from roadgpt.study.survey.survey import Item, Medium


def shown(item: Item, base: str) -> Markup:
    """The description and all media of an item."""
    lead = (
        "This road was made from the description:"
        if item.part == "alignment"
        else "Both roads were made from the same description:"
    )
    films = [medium for medium in item.media if medium.kind == "film"]
    views = [medium for medium in item.media if medium.kind == "view"]
    pictures = [_picture(medium, base) for medium in item.media if medium.kind == "picture"]
    return fill(
        '<section class="shown {part}" aria-label="What it is about"><p>{lead}</p>'
        "<blockquote>{prompt}</blockquote>"
        '<div class="pictures">{pictures}</div>{films}{views}</section>',
        part=item.part,
        lead=lead,
        prompt=item.prompt,
        pictures=joined(pictures),
        films=fill('<div class="films">{films}</div>', films=joined([_film(film, base) for film in films]))
        if films
        else "",
        views=joined([_view(view, base) for view in views]),
    )


def _address(medium: Medium, base: str) -> str:
    return f"{base}/media/{medium.name}"


def _picture(medium: Medium, base: str) -> Markup:
    return fill(
        '<figure><a href="{address}" target="_blank" rel="noopener" title="Open the picture larger">'
        '<img src="{address}" alt="{title}"></a><figcaption>{title}</figcaption></figure>',
        address=_address(medium, base),
        title=medium.title,
    )


def _film(medium: Medium, base: str) -> Markup:
    return fill(
        '<figure><video controls muted playsinline preload="metadata" src="{address}" aria-label="{title}">'
        '<a href="{address}">Film</a></video><figcaption>{title}</figcaption></figure>',
        address=_address(medium, base),
        title=medium.title,
    )


def _view(medium: Medium, base: str) -> Markup:
    # a frame in a closed part of the page is not loaded before it is opened
    return fill(
        '<details class="view"><summary>{title}</summary>'
        '<iframe src="{address}" title="{title}" loading="lazy" sandbox="allow-scripts"></iframe>'
        '<p><a href="{address}" target="_blank" rel="noopener">Open it in a tab of its own</a></p></details>',
        address=_address(medium, base),
        title=medium.title,
    )
