"""A server in this process that speaks OpenAI's protocol and plays the faults of those that claim to.

What it answers is a list of scenes, one for each request; the last is played again and again. A scene is a
function from the request to what happens on the wire.
"""

import json
import threading
import time
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, field
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer
from typing import Any

MODEL = "stub-model"


@dataclass
class HeardRequest:
    """What came in."""

    path: str
    headers: dict[str, str]
    body: dict[str, Any]

    @property
    def response_format(self) -> str:
        """How JSON was asked for: json_schema, json_object or text."""
        form = self.body.get("response_format") or self.body.get("text", {}).get("format") or {}
        return str(form.get("type", "text"))

    @property
    def last(self) -> str:
        """The last message."""
        turns = self.body.get("messages") or self.body.get("input") or [{"content": ""}]
        return str(turns[-1]["content"])


Scene = Callable[[HeardRequest, BaseHTTPRequestHandler], None]


@dataclass
class StubServer:
    """The server, and what it was asked."""

    url: str
    scenes: list[Scene]
    requests: list[HeardRequest] = field(default_factory=list)
    models: list[str] = field(default_factory=lambda: [MODEL])

    @property
    def response_formats(self) -> list[str]:
        return [request.response_format for request in self.requests]

    def play(self, *scenes: Scene) -> None:
        """From now on these."""
        self.scenes[:] = scenes
        self.requests.clear()


def send(
    handler: BaseHTTPRequestHandler, status: int, body: Any, headers: dict[str, str] | None = None
) -> None:
    content = body if isinstance(body, bytes) else json.dumps(body).encode()
    handler.send_response(status)
    for name, value in {"Content-Type": "application/json", **(headers or {})}.items():
        handler.send_header(name, value)
    handler.send_header("Content-Length", str(len(content)))
    handler.end_headers()
    handler.wfile.write(content)


def completion(text: Any, finish: str = "stop", **message: Any) -> dict[str, Any]:
    """The body of an answer of Chat Completions."""
    return {
        "id": "chatcmpl-1",
        "object": "chat.completion",
        "created": 1,
        "model": f"{MODEL}-2026-11-20",
        "choices": [
            {
                "index": 0,
                "finish_reason": finish,
                "message": {"role": "assistant", "content": text, **message},
            }
        ],
        "usage": {"prompt_tokens": 100, "completion_tokens": 50, "total_tokens": 150},
    }


def says(text: Any, finish: str = "stop", **message: Any) -> Scene:
    """An answer with this text, whatever was asked."""

    def scene(request: HeardRequest, handler: BaseHTTPRequestHandler) -> None:
        send(handler, 200, completion(text, finish, **message))

    return scene


def answers(body: Any) -> Scene:
    """Status 200 with this body."""
    return lambda request, handler: send(handler, 200, body)


def fails(status: int, message: str = "", headers: dict[str, str] | None = None, **told: Any) -> Scene:
    """An error as OpenAI words it."""
    body = {"error": {"message": message, "type": "error", "param": None, "code": None, **told}}
    return lambda request, handler: send(handler, status, body, headers)


def only(*formats: str, text: str, message: str = "response_format of this type is not supported") -> Scene:
    """A server that knows some ways of asking for JSON and refuses the others."""

    def scene(request: HeardRequest, handler: BaseHTTPRequestHandler) -> None:
        (says(text) if request.response_format in formats else fails(400, message))(request, handler)

    return scene


def refuses(parameter: str, text: str) -> Scene:
    """A server that refuses one parameter by name."""

    def scene(request: HeardRequest, handler: BaseHTTPRequestHandler) -> None:
        if parameter in request.body:
            fails(400, f"Unsupported parameter: '{parameter}' is not supported", param=parameter)(
                request, handler
            )
        else:
            says(text)(request, handler)

    return scene


def drips(seconds: float, text: str = "{}") -> Scene:
    """A byte now and then."""

    def scene(request: HeardRequest, handler: BaseHTTPRequestHandler) -> None:
        content = json.dumps(completion(text)).encode()
        handler.send_response(200)
        handler.send_header("Content-Length", str(len(content)))
        handler.end_headers()
        for place in range(len(content)):
            handler.wfile.write(content[place : place + 1])
            handler.wfile.flush()
            time.sleep(seconds)

    return scene


def drops(sent: bytes = b"", head: bytes = b"HTTP/1.1 200 OK\r\nContent-Length: 5000\r\n\r\n") -> Scene:
    """The connection ends, in the middle of an answer or before it."""

    def scene(request: HeardRequest, handler: BaseHTTPRequestHandler) -> None:
        if sent or not head.startswith(b"HTTP"):
            handler.wfile.write(head + sent)
        handler.close_connection = True
        handler.connection.close()

    return scene


def floods(megabytes: int) -> Scene:
    """Blanks, many more than were asked for."""

    def scene(request: HeardRequest, handler: BaseHTTPRequestHandler) -> None:
        handler.send_response(200)
        handler.send_header("Content-Length", str(megabytes * 1_000_000))
        handler.end_headers()
        for _ in range(megabytes):
            handler.wfile.write(b" " * 1_000_000)

    return scene


@contextmanager
def serving(*scenes: Scene) -> Iterator[StubServer]:
    """A server for the length of a block."""
    stub = StubServer("", list(scenes))

    class StubHandler(BaseHTTPRequestHandler):
        protocol_version = "HTTP/1.1"

        def do_GET(self) -> None:
            models = [{"id": name, "object": "model", "shutdown_date": None} for name in stub.models]
            send(self, 200, {"object": "list", "data": models})

        def do_POST(self) -> None:
            content = self.rfile.read(int(self.headers.get("Content-Length", 0)))
            body = json.loads(content) if content else {}
            request = HeardRequest(self.path, {**self.headers}, body)
            place = min(len(stub.requests), len(stub.scenes) - 1)
            stub.requests.append(request)
            try:
                stub.scenes[place](request, self)
            except OSError:  # whoever asked has gone
                self.close_connection = True

        def log_message(self, *args: Any) -> None:
            return

    class StubHttpServer(ThreadingHTTPServer):
        daemon_threads = True
        block_on_close = False

        def handle_error(self, request: Any, client_address: Any) -> None:
            return

    server = StubHttpServer(("127.0.0.1", 0), StubHandler)
    stub.url = f"http://127.0.0.1:{server.server_port}/v1"
    thread = threading.Thread(target=server.serve_forever, args=(0.01,), daemon=True)
    thread.start()
    try:
        yield stub
    finally:
        server.shutdown()
        server.server_close()
        thread.join()


def in_order(texts: Sequence[str]) -> list[Scene]:
    """Answers one after another."""
    return [says(text) for text in texts]
