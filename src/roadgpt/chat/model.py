"""The data types of a conversation with a language model, and the addresses of servers."""

from typing import Any, Literal, Self
from urllib.parse import urlsplit

from pydantic import BaseModel, ConfigDict, SerializeAsAny, field_validator

from roadgpt.provenance import SERVERS
from roadgpt.settings import CHAT, ROWS, field, span

OPENAI = "https://api.openai.com/v1"
DOORS = ("/chat/completions", "/models")  # endpoints that a copied base URL may end with
PORTS = {"http": 80, "https": 443}

Origin = tuple[str, str, int | None]


def address_of(base_url: str | None) -> str:
    """Returns the URL of a server without an endpoint such as ``/models``; None stands for OpenAI's server.

    If ``base_url`` has no path, ``/v1`` is appended, or ``/openai/v1`` for Azure."""
    place = (base_url or OPENAI).rstrip("/")
    for door in DOORS:
        place = place.removesuffix(door)
    parts = urlsplit(place)
    if parts.path:
        return place
    return place + ("/openai/v1" if (parts.hostname or "").endswith(".azure.com") else "/v1")


def origin_of(base_url: str | None) -> Origin:
    """Returns the scheme, host and port of a URL, in normal form; None stands for OpenAI's server. The port
    is None if the URL has no valid port and the scheme is neither http nor https."""
    parts = urlsplit((base_url or OPENAI).strip())
    scheme = parts.scheme.lower()
    try:
        port = parts.port
    except ValueError:
        port = None
    return scheme, (parts.hostname or "").lower().rstrip("."), port or PORTS.get(scheme)


OPTIONS = ROWS[CHAT]
LEAST_REPLY = int(span(OPTIONS["max_completion"])[0])  # tokens
DECIMALS = 9  # of seconds and USD, so that a difference of sums does not depend on earlier costs
Role = Literal["system", "user", "assistant"]


class ChatValue(BaseModel):
    """Base of immutable values that are compared by content and read from and written to JSON."""

    model_config = ConfigDict(frozen=True, extra="forbid", hide_input_in_errors=True)  # it may hold a key


class Message(ChatValue):
    """One message of a conversation."""

    role: Role
    text: str


class Usage(ChatValue):
    """Numbers of tokens, as the server counts them."""

    prompt: int = 0
    completion: int = 0

    @property
    def total(self) -> int:
        """The number of tokens of question and answer together."""
        return self.prompt + self.completion

    def __add__(self, other: "Usage") -> "Usage":
        return Usage(prompt=self.prompt + other.prompt, completion=self.completion + other.completion)


class Reply(ChatValue):
    """The answer to one question; its tokens, seconds and cost include failed attempts."""

    text: str
    """The text as the model wrote it; it may be shown but never executed."""
    data: SerializeAsAny[Any] = None
    """A validated instance of the schema; None if no schema was given."""
    model: str
    """The name of the model that answered, as the server reports it."""
    usage: Usage = Usage()
    seconds: float = 0.0
    cost: float | None = None
    """The cost in USD; None if the price of the model is unknown."""
    finish: str = "stop"


class Spent(ChatValue):
    """What a conversation has cost so far, including questions without a usable answer."""

    calls: int = 0
    """Number of requests that the server answered."""
    usage: Usage = Usage()
    seconds: float = 0.0
    cost: float | None = 0.0
    """The cost in USD; None if any model that was asked has an unknown price."""

    def __add__(self, other: "Spent") -> "Spent":
        cost = None if self.cost is None or other.cost is None else self.cost + other.cost
        return Spent(
            calls=self.calls + other.calls,
            usage=self.usage + other.usage,
            seconds=self.seconds + other.seconds,
            cost=cost,
        )

    def since(self, before: "Spent") -> "Spent":
        """Returns the difference between this total and an earlier total, ``before``."""
        now, old = self.usage, before.usage
        usage = Usage(prompt=now.prompt - old.prompt, completion=now.completion - old.completion)
        cost = None if self.cost is None or before.cost is None else round(self.cost - before.cost, DECIMALS)
        seconds = round(self.seconds - before.seconds, DECIMALS)
        return Spent(calls=self.calls - before.calls, usage=usage, seconds=seconds, cost=cost)


class ChatSettings(ChatValue):
    """Which language model to ask, and how. The settings are stored in run folders and never contain an
    API key."""

    provider: str = field(OPTIONS["provider"])
    """Name of an installed provider."""
    model: str | None = field(OPTIONS["model"])
    """With None, the server must have only one model, which is used."""
    base_url: str | None = field(OPTIONS["base_url"])
    temperature: float | None = field(OPTIONS["temperature"])
    timeout: float = field(OPTIONS["timeout"])
    retries: int = field(OPTIONS["retries"])
    max_completion: int = field(OPTIONS["max_completion"])
    max_tokens: int | None = field(OPTIONS["max_tokens"])
    max_cost: float | None = field(OPTIONS["max_cost"], allow_inf_nan=False)
    price: str | None = field(OPTIONS["price"])
    record: str | None = field(OPTIONS["record"], exclude=True)
    """Left out of saved files, as is ``replay``, so that a replay writes the same files."""
    replay: str | None = field(OPTIONS["replay"], exclude=True)
    rounds: int = field(OPTIONS["rounds"])

    @field_validator("base_url")
    @classmethod
    def _holds_no_key(cls, url: str | None) -> str | None:
        if url is None:
            return None
        try:
            parts = urlsplit(url.strip())
            _ = parts.port
        except ValueError:
            raise ValueError("the base URL cannot be read; write it like http://localhost:11434/v1") from None
        if parts.scheme not in ("http", "https") or not parts.hostname:
            raise ValueError("that is not a base URL; write it like http://localhost:11434/v1")
        if parts.username is not None or parts.query or parts.fragment:
            raise ValueError(
                "the base URL holds more than an address; put the key into OPENAI_API_KEY and leave "
                "out user names and everything after ? or #"
            )
        return url.strip().rstrip("/")

    @field_validator("price")
    @classmethod
    def _has_two_prices(cls, price: str | None) -> str | None:
        if price is not None:
            two_prices(price)
        return price

    def essence(self) -> Self:
        """Returns a copy of the settings with defaults for all fields that may change when a campaign is
        resumed: the limits of tokens and money, the price, the time-out, the retries and the folders of
        recordings."""
        usual = type(self)()
        spare = ("timeout", "retries", "max_tokens", "max_cost", "price", "record", "replay")
        return self.model_copy(update={name: getattr(usual, name) for name in spare})

    def came_with(self, file: object) -> Self:
        """Returns the settings without the folders of recordings, and remembers that ``file``, not the user,
        chose the server. Use it for settings from a file that somebody else may have written, so that the
        user's API key is not sent to that server."""
        if self.base_url:
            SERVERS.add_from_file(str(origin_of(self.base_url)), file)
        return self.model_copy(update={"record": None, "replay": None})


def two_prices(text: str) -> tuple[float, float]:
    """Parses a text such as "0.15/0.60" into USD per million tokens of prompt and of completion; raises
    ValueError if the text is not two numbers, from 0 to less than a million."""
    try:
        prompt, completion = (float(part) for part in text.split("/"))
    except ValueError:
        prompt = completion = -1.0
    if not (0 <= prompt < 1e6 and 0 <= completion < 1e6):
        raise ValueError("a price is two numbers, USD per million tokens of question and answer: 0.15/0.60")
    return prompt, completion
