"""Serves agents over standard input and output, or over HTTP on this machine: those that know the token."""

import hmac
import secrets
import socket
import sys
from typing import Any

import anyio
import uvicorn
from mcp.server import Server
from mcp.server.stdio import stdio_server
from mcp.server.transport_security import TransportSecuritySettings
from starlette.responses import PlainTextResponse
from starlette.types import ASGIApp, Receive, Scope, Send

from roadgpt.errors import RoadGPTError, explained


def guarded(app: ASGIApp, token: str) -> ASGIApp:
    """Returns an application that answers 401 to requests without the token."""
    refusal = PlainTextResponse("send what roadgpt mcp printed: Authorization: Bearer TOKEN\n", 401)

    async def guard(scope: Scope, receive: Receive, send: Send) -> None:
        given = dict(scope.get("headers", ())).get(b"authorization", b"")
        is_known = hmac.compare_digest(given, f"Bearer {token}".encode()) or scope["type"] == "lifespan"
        await (app if is_known else refusal)(scope, receive, send)

    return guard


async def _over_streams(server: Server[Any]) -> None:
    async with stdio_server() as (heard, said):
        await server.run(heard, said, server.create_initialization_options())


def serve(server: Server[Any], port: int | None) -> None:
    """Serves one agent, until it closes standard input; or until Ctrl-C those that send the printed token."""
    if port is None:
        anyio.run(_over_streams, server)
        return
    with explained(RoadGPTError, f"cannot listen on port {port}", "give another one, or 0 for any"):
        listening = socket.create_server(("127.0.0.1", port))
    names = [f"{host}:{listening.getsockname()[1]}" for host in ("127.0.0.1", "localhost")]
    origins, token = [f"http://{name}" for name in names], secrets.token_urlsafe(32)
    security = TransportSecuritySettings(allowed_hosts=names, allowed_origins=origins)
    app = guarded(server.streamable_http_app(transport_security=security), token)
    print(f"{origins[0]}/mcp\nAuthorization: Bearer {token}", file=sys.stderr, flush=True)
    anyio.run(uvicorn.Server(uvicorn.Config(app, log_config=None, access_log=False)).serve, [listening])
