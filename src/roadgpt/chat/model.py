"""The values of a conversation with a language model: Message, Usage, Reply, ChatSettings, Spent."""

from typing import Annotated, Any, Literal, Self
from urllib.parse import urlsplit

from pydantic import BaseModel, ConfigDict, Field, SerializeAsAny, field_validator

from roadgpt.chat.address import origin_of
from roadgpt.provenance import SERVERS

Api = Literal["chat", "responses"]
Repair = Literal["none", "place", "full"]
Strategy = Literal["whole", "stepwise"]
DECIMALS = 9  # of seconds and USD: a difference of sums is the same whatever came before
Role = Literal["system", "user", "assistant"]


class ChatValue(BaseModel):
    """A value: never changed, compared by content, read from and written to JSON."""

    model_config = ConfigDict(frozen=True, extra="forbid", hide_input_in_errors=True)  # it may hold a key


class Message(ChatValue):
    """One turn of a conversation."""

    role: Role
    text: str


class Usage(ChatValue):
    """Tokens, as the server counts them."""

    prompt: int = 0
    completion: int = 0

    @property
    def total(self) -> int:
        """Both together."""
        return self.prompt + self.completion

    def __add__(self, other: "Usage") -> "Usage":
        return Usage(prompt=self.prompt + other.prompt, completion=self.completion + other.completion)


class Reply(ChatValue):
    """What came of one question, all attempts at an answer together."""

    text: str
    """As the model wrote it: data, to be shown and never to be run."""
    data: SerializeAsAny[Any] = None
    """An instance of the schema that was asked for, validated; None where none was."""
    model: str
    """As the server calls the model that answered."""
    usage: Usage = Usage()
    seconds: float = 0.0
    cost: float | None = None
    """USD; None: the price of this model is not known."""
    finish: str = "stop"
    conversation: str | None = None
    """Where the server keeps the conversation, with ``api="responses"``."""


class Spent(ChatValue):
    """What a conversation has cost so far, questions that came to nothing included."""

    calls: int = 0
    """Requests that the server answered."""
    usage: Usage = Usage()
    seconds: float = 0.0
    cost: float | None = 0.0
    """USD; None: a model was asked whose price is not known."""

    def __add__(self, other: "Spent") -> "Spent":
        cost = None if self.cost is None or other.cost is None else self.cost + other.cost
        return Spent(
            calls=self.calls + other.calls,
            usage=self.usage + other.usage,
            seconds=self.seconds + other.seconds,
            cost=cost,
        )

    def since(self, before: "Spent") -> "Spent":
        """What was spent after ``before``."""
        cost = None if self.cost is None or before.cost is None else round(self.cost - before.cost, DECIMALS)
        return Spent(
            calls=self.calls - before.calls,
            usage=Usage(
                prompt=self.usage.prompt - before.usage.prompt,
                completion=self.usage.completion - before.usage.completion,
            ),
            seconds=round(self.seconds - before.seconds, DECIMALS),
            cost=cost,
        )


class ChatSettings(ChatValue):
    """Which language model is asked, and how; goes into run folders and never holds a key."""

    provider: str = "openai"
    """A name on the shelf ``providers``."""
    model: str | None = None
    """As the server calls it; None: the only one that the server has."""
    base_url: str | None = None
    """Of the server, up to ``/v1``; None: OpenAI's own."""
    api: Api = "chat"
    """Chat Completions, or Responses with a conversation that the server keeps."""
    temperature: Annotated[float, Field(ge=0, le=2)] | None = None
    """None: the server's own."""
    timeout: Annotated[float, Field(gt=0, le=86_400)] = 60.0
    """Seconds for one whole answer."""
    retries: Annotated[int, Field(ge=0, le=20)] = 3
    """Of a request that failed for want of the server, not of the question."""
    max_completion: Annotated[int, Field(ge=16, le=1_000_000)] = 4096
    """Tokens of one reply."""
    max_tokens: Annotated[int, Field(ge=1)] | None = None
    """Of the whole campaign, questions and answers."""
    max_cost: Annotated[float, Field(gt=0, allow_inf_nan=False)] | None = None
    """USD, of the whole campaign."""
    price: str | None = None
    """USD per million tokens of prompt and completion, as "0.15/0.60"; None: from the table."""
    record: str | None = Field(default=None, exclude=True)
    """Folder in which every exchange is kept; stands in no file, so that a replay gives the same files."""
    replay: str | None = Field(default=None, exclude=True)
    """Folder from which every exchange is taken, instead of asking a server."""
    rounds: Annotated[int, Field(ge=1, le=20)] = 3
    """Questions for one road, at most."""
    repair: Repair = "full"
    strategy: Strategy = "whole"

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
            raise ValueError("that is no base URL; write it like http://localhost:11434/v1")
        if parts.username is not None or parts.query or parts.fragment:
            raise ValueError(
                "the base URL holds more than a place; put the key into OPENAI_API_KEY and leave "
                "user names and everything behind ? or # away"
            )
        return url.strip().rstrip("/")

    @field_validator("price")
    @classmethod
    def _has_two_prices(cls, price: str | None) -> str | None:
        if price is not None:
            two_prices(price)
        return price

    def essence(self) -> Self:
        """Without what may be another when an interrupted campaign goes on: limits, patience, recordings."""
        usual = type(self)()
        spare = ("timeout", "retries", "max_tokens", "max_cost", "price", "record", "replay")
        return self.model_copy(update={name: getattr(usual, name) for name in spare})

    def came_with(self, file: object) -> Self:
        """The same, out of a file that may be somebody else's: no key for its server, no folders."""
        if self.base_url:
            SERVERS.came_with(str(origin_of(self.base_url)), file)
        return self.model_copy(update={"record": None, "replay": None})


def two_prices(text: str) -> tuple[float, float]:
    """USD per million tokens of prompt and of completion, from "0.15/0.60".

    Raises:
        ValueError: it is not two numbers.
    """
    try:
        prompt, completion = (float(part) for part in text.split("/"))
    except ValueError:
        prompt = completion = -1.0
    if not (0 <= prompt < 1e6 and 0 <= completion < 1e6):
        raise ValueError("a price is two numbers, USD per million tokens of question and answer: 0.15/0.60")
    return prompt, completion
