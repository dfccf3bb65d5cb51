"""A Chat in this process: it has its answers written down, and remembers what it was asked."""

from collections.abc import Callable, Sequence

from pydantic import BaseModel

from roadgpt.chat import Message, Reply, Spent, UnparsableError, Usage
from roadgpt.chat.answer import NotReadableError, read_as

Line = str | Exception | Callable[[Sequence[Message]], str]


class FakeChat:
    """Says its lines one after another, the last of them again and again; an exception is raised."""

    def __init__(self, *lines: Line) -> None:
        self.lines = list(lines)
        self.asked: list[list[Message]] = []
        self.spent = Spent()

    @property
    def questions(self) -> list[str]:
        """The last message of every question."""
        return [messages[-1].text for messages in self.asked]

    def ask(self, messages: Sequence[Message], schema: type[BaseModel] | None = None) -> Reply:
        line = self.lines[min(len(self.asked), len(self.lines) - 1)]
        self.asked.append(list(messages))
        if isinstance(line, Exception):
            raise line
        text = line if isinstance(line, str) else line(messages)
        usage = Usage(prompt=100, completion=20)
        self.spent = self.spent + Spent(calls=1, usage=usage, seconds=0.5, cost=0.001)
        try:
            data = None if schema is None else read_as(schema, text)
        except NotReadableError as error:
            raise UnparsableError(f"no answer can be used: {error}", text) from None
        return Reply(text=text, data=data, model="fake-1", usage=usage, seconds=0.5, cost=0.001)
