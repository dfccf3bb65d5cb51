"""Where a server is: its address as it is asked, and its origin, which a key belongs to."""

from urllib.parse import urlsplit

OPENAI = "https://api.openai.com/v1"
DOORS = ("/chat/completions", "/responses", "/models")  # of a base URL that was copied with its door
PORTS = {"http": 80, "https": 443}

Origin = tuple[str, str, int | None]


def address_of(base_url: str | None) -> str:
    """The address of a server, with the path that its kind has where none was given."""
    place = (base_url or OPENAI).rstrip("/")
    for door in DOORS:
        place = place.removesuffix(door)
    parts = urlsplit(place)
    if parts.path:
        return place
    return place + ("/openai/v1" if (parts.hostname or "").endswith(".azure.com") else "/v1")


def origin_of(base_url: str | None) -> Origin:
    """Scheme, host and port, small letters and all said; of OpenAI where no server is named."""
    parts = urlsplit((base_url or OPENAI).strip())
    scheme = parts.scheme.lower()
    try:
        port = parts.port
    except ValueError:
        port = None
    return scheme, (parts.hostname or "").lower().rstrip("."), port or PORTS.get(scheme)
