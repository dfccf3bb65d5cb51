"""The fake's sockets and faults: takes messages, hands them to their methods, and fails on demand.

Wire: a big-endian uint32 length, then one MessagePack map; ``_id`` comes back; the first message of every
socket is Hello; every vehicle has its own server. As Lua does, numbers go out as floats (``_id`` as well),
an empty map goes out as an empty list, and what is nil is missing.
"""

import json
import os
import random
import socket
import struct
import threading
from abc import ABC, abstractmethod
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path

import msgpack

LEVELS = {"tech_ground": 0.0, "smallgrid": 0.0}  # and the heights of their ground


class FakeRefusedError(Exception):
    """What the simulator would not take; its text is the error that the client is told."""


@dataclass
class FakeFault:
    """Something that goes wrong once: at the nth message of a type within the nth scenario."""

    kind: str
    """hang, drop, die, error, value_error, wrong_ack, garbage or half."""
    on: str = "SensorRequest"
    scenario: int = 1
    nth: int = 1


@dataclass
class FakeSettings:
    """How this fake is set up."""

    protocol: str = "v1.27"
    faults: tuple = ()
    slow_start: float = 0.0
    levels: tuple = tuple(LEVELS)
    steer_sign: float = -1.0
    told_sign: float = 1.0
    """Of the steering input that is told, against that which was commanded."""
    is_blind: bool = False
    """The AI does not see roads of prefabs."""
    tech: bool = True
    state: str = ""
    """A file that survives restarts: scenarios so far, and faults that have been."""


QUIET = (20_000, 30_000)
"""Ports below those that systems give to clients (32768 and up on Linux, 49152 elsewhere)."""


def _bound(port):
    server = socket.socket()
    server.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
    try:
        server.bind(("127.0.0.1", port))
    except OSError:
        server.close()
        raise
    return server


def _on_a_quiet_port():
    """A server on a port from which no client calls, and of which the next ports are as quiet: the simulator
    tries those if it may not take this one.
    """
    draw = random.Random()
    while True:
        with suppress(OSError):
            return _bound(draw.randrange(*QUIET, 10))


class FakeServer(ABC):
    """Answers a message by its method ``ge_TYPE`` or, of a vehicle, ``veh_TYPE``.

    ``transcript`` lists (vehicle or "", type) of all messages, ``unknown`` those not known, ``broken`` faults
    of the fake itself.
    """

    def __init__(self, settings, port=0):
        self.settings = settings
        self.lock = threading.RLock()
        self.transcript, self.unknown, self.broken = [], [], []
        self.counts, self.quit = {}, threading.Event()
        self.made, self.fired = 0, []
        self._sockets = []
        self._remember(read=True)
        self.port = self._serve("", port)

    @abstractmethod
    def _car(self, name):
        """The car of that name."""

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self.stop()

    def stop(self):
        self.quit.set()
        for each in list(self._sockets):
            with suppress(OSError):
                each.shutdown(socket.SHUT_RDWR)
            each.close()

    # --- sockets -----------------------------------------------------------------------------------------

    def _serve(self, vehicle, port=0):
        server = _bound(port) if port else _on_a_quiet_port()
        server.listen()
        self._sockets.append(server)
        threading.Thread(target=self._accept, args=(server, vehicle), daemon=True).start()
        return server.getsockname()[1]

    def _accept(self, server, vehicle):
        while not self.quit.is_set():
            try:
                client, _ = server.accept()
            except OSError:
                return
            client.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
            self._sockets.append(client)
            threading.Thread(target=self._talk, args=(client, vehicle), daemon=True).start()

    def _talk(self, client, vehicle):
        has_greeted = False
        with suppress(OSError, EOFError):
            while True:
                (length,) = struct.unpack("!I", _exactly(client, 4))
                message = msgpack.unpackb(_exactly(client, length), raw=False, strict_map_key=False)
                kind, number = message.pop("type"), message.pop("_id")
                if not has_greeted and kind != "Hello":
                    break  # who does not greet is not talked to
                has_greeted = True
                reply = self._answer(vehicle, kind, message, client)
                if reply is not None:
                    _send(client, {**reply, "_id": number})
        with suppress(OSError):
            client.close()

    def _answer(self, vehicle, kind, message, client):
        with self.lock:
            self.transcript.append((vehicle, kind))
            fault = self._fault(kind)
        if fault is not None:
            spoilt = self._fail(fault, kind, client)
            if spoilt is not None:
                return spoilt
        with self.lock:
            handler = getattr(self, f"{'veh' if vehicle else 'ge'}_{kind}", None)
            if kind == "Hello":
                return {"type": "Hello", "protocolVersion": self.settings.protocol}
            if handler is None:
                self.unknown.append((vehicle, kind))
                return {"bngValueError": f"the fake knows no message {kind}"}
            try:
                return handler(self._car(vehicle), message) if vehicle else handler(message)
            except FakeRefusedError as error:
                return {"bngError": str(error)}
            except Exception as error:
                self.broken.append(f"{kind}: {error!r}")
                return {"bngError": f"the fake broke: {error!r}"}

    # --- faults ------------------------------------------------------------------------------------------

    def _fault(self, kind):
        key = (self.made, kind)
        self.counts[key] = self.counts.get(key, 0) + 1
        for index, fault in enumerate(self.settings.faults):
            if index in self.fired or (fault.scenario, fault.on) != key:
                continue
            if self.counts[key] >= fault.nth:
                self.fired.append(index)
                self._remember()
                return fault
        return None

    def _fail(self, fault, kind, client):
        if fault.kind == "hang":
            self.quit.wait(3600)
            raise EOFError
        if fault.kind == "die":
            if self.settings.state:
                os._exit(1)
            self.stop()
            raise EOFError
        if fault.kind == "drop":
            client.shutdown(socket.SHUT_RDWR)
            raise EOFError
        if fault.kind == "half":
            client.sendall(struct.pack("!I", 100) + b"only this")
            client.shutdown(socket.SHUT_RDWR)
            raise EOFError
        if fault.kind == "garbage":
            client.sendall(struct.pack("!I", 4) + b"\xc1\xc1\xc1\xc1")
            raise EOFError
        return {
            "error": {"bngError": f"a Lua error in {kind}"},
            "value_error": {"bngValueError": f"a wrong value in {kind}"},
            "wrong_ack": {"type": "SomethingElse"},
        }[fault.kind]

    def _remember(self, read=False):
        """Keep, or take up, what must survive a restart of this process."""
        path = Path(self.settings.state) if self.settings.state else None
        if path is None:
            return
        if read and path.exists():
            kept = json.loads(path.read_text())
            self.made, self.fired = kept["made"], kept["fired"]
        elif not read:
            path.write_text(json.dumps({"made": self.made, "fired": self.fired}))


def _exactly(client, length):
    parts = b""
    while len(parts) < length:
        part = client.recv(length - len(parts))
        if not part:
            raise EOFError
        parts += part
    return parts


def _send(client, reply):
    data = msgpack.packb(_as_lua(reply), use_bin_type=True)
    client.sendall(struct.pack("!I", len(data)) + data)


def _as_lua(value):
    if isinstance(value, dict):
        return {key: _as_lua(each) for key, each in value.items() if each is not None} or []
    if isinstance(value, (list, tuple)):
        return [_as_lua(each) for each in value]
    return float(value) if isinstance(value, int) and not isinstance(value, bool) else value
