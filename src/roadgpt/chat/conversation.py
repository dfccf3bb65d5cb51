"""One conversation through the Responses API, which replaces the discontinued Assistants API.

If the server can store the conversation, the model remembers the earlier roads of a campaign. Otherwise, the
most recent messages are sent again with each request.
"""

from collections.abc import Sequence
from typing import Any

from roadgpt.chat.answer import Answer, from_responses
from roadgpt.chat.client import ApiClient
from roadgpt.chat.model import Message
from roadgpt.chat.request_error import RequestError
from roadgpt.chat.server_quirks import ServerQuirks

MOST_TURNS = 20  # messages that are sent along if the server stores none
FULL = ("context_length", "context window", "too long", "maximum context")


class Conversation:
    """The conversation of one campaign with a model: its most recent messages and, if the server stores the
    conversation, its id there.
    """

    def __init__(self) -> None:
        self.name: str | None = None
        """Id of the conversation on the server."""
        self._turns: list[Message] = []

    def keep(self, messages: Sequence[Message], answer: str) -> None:
        """Stores the messages and the answer of one successful exchange."""
        said = [message for message in messages if message.role != "system"]
        self._turns = [*self._turns, *said, Message(role="assistant", text=answer)][-MOST_TURNS:]

    def respond(
        self, client: ApiClient, quirks: ServerQuirks, messages: Sequence[Message], body: dict[str, Any]
    ) -> Answer:
        """Sends messages that continue the conversation, and returns the answer."""
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
            if not any(word in fault.details for word in FULL):
                raise
            self.name = None  # it has grown too long: start a new one
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
