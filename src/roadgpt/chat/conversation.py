"""A Talk: one conversation through Responses, which stands in the place of the Assistants API that is gone.

The server keeps it where it can, so that each new road knows the earlier ones. Where a server has Responses
and keeps nothing, the last turns are sent along.
"""

from collections.abc import Sequence
from typing import Any

from roadgpt.chat.answer import Answer, from_responses
from roadgpt.chat.client import ApiClient
from roadgpt.chat.model import Message
from roadgpt.chat.request_error import RequestError
from roadgpt.chat.server_quirks import ServerQuirks

MOST_TURNS = 20  # messages that are sent along where the server keeps none
FULL = ("context_length", "context window", "too long", "maximum context")


class Conversation:
    """What was said so far in one campaign."""

    def __init__(self) -> None:
        self.name: str | None = None
        """Of the conversation on the server."""
        self._turns: list[Message] = []

    def keep(self, messages: Sequence[Message], answer: str) -> None:
        """Remember one exchange that came to something."""
        said = [message for message in messages if message.role != "system"]
        self._turns = [*self._turns, *said, Message(role="assistant", text=answer)][-MOST_TURNS:]

    def respond(
        self, client: ApiClient, quirks: ServerQuirks, messages: Sequence[Message], body: dict[str, Any]
    ) -> Answer:
        """The answer to messages behind all that was said before."""
        rules = "\n\n".join(message.text for message in messages if message.role == "system")
        asked = [message for message in messages if message.role != "system"]
        if rules:
            body = {**body, "instructions": rules}
        if self.name is None and quirks.keeps_conversations:
            self._begin(client, quirks)
        if self.name is None:
            asked = [*self._turns, *asked]
            return from_responses(client.respond({**body, "input": _input(asked), "store": False}))
        try:
            return from_responses(client.respond({**body, "input": _input(asked), "conversation": self.name}))
        except RequestError as fault:
            if not any(word in fault.said for word in FULL):
                raise
            self.name = None  # it has grown too long: begin another one
            self._begin(client, quirks)
            rest = {"conversation": self.name} if self.name else {"store": False}
            return from_responses(client.respond({**body, "input": _input(asked), **rest}))

    def _begin(self, client: ApiClient, quirks: ServerQuirks) -> None:
        try:
            name = client.begin_conversation().get("id")
        except RequestError as fault:
            if fault.status not in (400, 403, 404, 405, 422, 501):
                raise
            name = None
        self.name = name if isinstance(name, str) and name else None
        quirks.keeps_conversations = self.name is not None


def _input(messages: Sequence[Message]) -> list[dict[str, str]]:
    return [{"role": message.role, "content": message.text} for message in messages]
