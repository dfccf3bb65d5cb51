"""Handles the addresses of servers: the URL for requests, and the origin (scheme, host, port) for which a
key is valid.
"""

from urllib.parse import urlsplit

OPENAI = "https://api.openai.com/v1"
DOORS = ("/chat/completions", "/responses", "/models")  # endpoints that a copied base URL may end with
PORTS = {"http": 80, "https": 443}

Origin = tuple[str, str, int | None]


def address_of(base_url: str | None) -> str:
    """Returns the URL of a server without an endpoint such as ``/models``; None stands for OpenAI's server.

    If ``base_url`` has no path, ``/v1`` is appended, or ``/openai/v1`` for Azure.
    """
    place = (base_url or OPENAI).rstrip("/")
    for door in DOORS:
        place = place.removesuffix(door)
    parts = urlsplit(place)
    if parts.path:
        return place
    return place + ("/openai/v1" if (parts.hostname or "").endswith(".azure.com") else "/v1")


def origin_of(base_url: str | None) -> Origin:
    """Returns the scheme, host and port of a URL, in normal form; None stands for OpenAI's server. The port
    is None if the URL has no valid port and the scheme is neither http nor https.
    """
    parts = urlsplit((base_url or OPENAI).strip())
    scheme = parts.scheme.lower()
    try:
        port = parts.port
    except ValueError:
        port = None
    return scheme, (parts.hostname or "").lower().rstrip("."), port or PORTS.get(scheme)
