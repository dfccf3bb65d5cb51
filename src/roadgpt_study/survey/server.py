"""Serves a survey with uvicorn, and adds limits on connections that uvicorn lacks."""

import logging
import socket
from asyncio import TimerHandle, Transport
from threading import Event, Thread
from typing import Any

import h11
import uvicorn
from uvicorn.protocols.http.h11_impl import H11Protocol

from roadgpt.errors import UsageError
from roadgpt_study.survey.app import SurveyApp

MOST_AT_ONCE = 600  # connections; a browser opens up to six
MOST_HEAD = 32 * 1024  # bytes of a request before its body
PATIENCE = 15  # s that a connection may be silent between requests, or take to receive 64 kB
SLOWEST = 60.0  # s in which a whole request must have arrived, even if its bytes come slowly
BACKLOG = 128  # connections that wait to be accepted
LONGEST_END = 5.0  # s in which requests under way may end, after Ctrl-C
BUSY = b"HTTP/1.1 503 Service Unavailable\r\nConnection: close\r\nRetry-After: 2\r\nContent-Length: 0\r\n\r\n"
WAITS_FOR_CLIENT = (h11.IDLE, h11.SEND_BODY)


class LimitedConnection(H11Protocol):
    """One connection of a rater, which is closed if it takes too long to send or to receive data."""

    def __init__(self, *args: Any, **more: Any) -> None:
        super().__init__(*args, **more)
        self._timers: dict[str, TimerHandle] = {}

    def connection_made(self, transport: Transport) -> None:  # type: ignore[override]
        """Accepts a connection, or answers with status 503 if too many are open."""
        super().connection_made(transport)
        # else answers take 40 ms longer: their body waits until the other side has confirmed their head
        transport.get_extra_info("socket").setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
        if len(self.connections) >= (self.limit_concurrency or MOST_AT_ONCE):
            transport.write(BUSY)
            transport.close()
        else:
            self._watch()

    def data_received(self, data: bytes) -> None:
        """Receives some bytes of a request."""
        super().data_received(data)
        self._watch()

    def on_response_complete(self) -> None:
        """After a response is complete, starts the time limit for the next request."""
        self._stop("request")
        super().on_response_complete()
        self._watch()

    def pause_writing(self) -> None:
        """Limits how long the rater's browser may take to receive most of what was sent."""
        super().pause_writing()
        self._start("answer", PATIENCE)

    def resume_writing(self) -> None:
        """Continues sending after the rater's browser has received most of what was sent."""
        self._stop("answer")
        super().resume_writing()

    def connection_lost(self, exc: Exception | None) -> None:
        """Stops the timers of a closed connection."""
        self._stop("request")
        self._stop("answer")
        super().connection_lost(exc)

    def _watch(self) -> None:
        """Limits the time from the end of the last answer until the whole next request has arrived."""
        if self.conn.their_state not in WAITS_FOR_CLIENT:
            self._stop("request")
        elif "request" not in self._timers:
            self._start("request", SLOWEST)

    def _start(self, name: str, seconds: float) -> None:
        self._timers[name] = self.loop.call_later(seconds, self.transport.abort)

    def _stop(self, name: str) -> None:
        if timer := self._timers.pop(name, None):
            timer.cancel()


class Server:
    """Serves one survey; it listens at once, and answers requests while ``serve_forever`` runs."""

    def __init__(
        self, app: SurveyApp, host: str = "127.0.0.1", port: int = 0, most: int = MOST_AT_ONCE
    ) -> None:
        self.app = app
        try:
            family = socket.getaddrinfo(host, port, type=socket.SOCK_STREAM)[0][0]
            self._socket = socket.create_server((host, port), family=family, backlog=BACKLOG)
        except (OSError, OverflowError) as error:
            reason = getattr(error, "strerror", None) or error
            raise UsageError(
                f"cannot listen on {host}, port {port} ({reason}); name another with --port or --host"
            ) from error
        self.port = int(self._socket.getsockname()[1])
        config = uvicorn.Config(
            app.asgi,
            loop="asyncio",  # the same whatever else is installed
            http=LimitedConnection,
            ws="none",
            lifespan="off",
            log_config=None,
            log_level=logging.CRITICAL,  # addresses are raters' keys; the application tells errors
            access_log=False,
            proxy_headers=False,
            server_header=False,
            limit_concurrency=most + 1,  # uvicorn refuses the last one itself
            timeout_keep_alive=PATIENCE,
            timeout_graceful_shutdown=1,
            h11_max_incomplete_event_size=MOST_HEAD,
        )
        self._uvicorn = uvicorn.Server(config)
        self._has_ended = Event()

    def serve_forever(self) -> None:
        """Answers requests until ``stop`` is called or a KeyboardInterrupt is raised in this thread. uvicorn
        has another thread, or it would take a KeyboardInterrupt for an error of the application, and
        continue."""
        thread = Thread(target=self._run, daemon=True)
        try:
            thread.start()
            # not Thread.join: after a KeyboardInterrupt in join, Python treats the thread as ended
            while not self._has_ended.wait(0.5):
                pass
        finally:
            self.stop()
            if thread.ident is not None:
                self._has_ended.wait(LONGEST_END)

    def _run(self) -> None:
        try:
            self._uvicorn.run([self._socket])
        except OSError:
            if not self._uvicorn.should_exit:  # else the socket was closed before uvicorn had begun
                raise
        finally:
            self._has_ended.set()

    def stop(self) -> None:
        """Makes ``serve_forever`` return soon, without waiting for raters. Any thread may call it."""
        self._uvicorn.should_exit = self._uvicorn.force_exit = True

    def close(self) -> None:
        """Stops listening."""
        self._socket.close()
