"""The service: answers the competition's evaluator over gRPC."""

import logging
from collections.abc import Iterable, Iterator
from concurrent.futures import ThreadPoolExecutor
from typing import Any

import grpc

from roadgpt.errors import UsageError
from roadgpt.sbft.sdc.messages import METHODS, SERVICE, message
from roadgpt.sbft.sdc.risk import BY_LINE, Signs, learnt, order, signs_of

log = logging.getLogger(__name__)

NAME = "RoadGPT"
MOST_LEARNT = 5000  # known outcomes that are looked at: some 6 s of processor time
WORKERS = 4


class Service:
    """One evaluator's counterpart. Each method is an RPC."""

    def __init__(self) -> None:
        """A service that has learnt nothing yet."""
        self.weighing = BY_LINE

    def name(self, request: Any, context: Any) -> Any:
        """What the tool is called."""
        return message("NameReply")(name=NAME)

    def initialize(self, requests: Iterable[Any], context: Any) -> Any:
        """Learn from tests whose outcomes are known."""
        oracles = list(requests)
        chosen = oracles[:: max(1, -(-len(oracles) // MOST_LEARNT))]
        signs = self._signs(oracle.testCase for oracle in chosen)
        self.weighing = learnt(signs, [bool(oracle.hasFailed) for oracle in chosen])
        log.info("%d of %d known outcomes were looked at", len(chosen), len(oracles))
        return message("InitializationReply")(ok=True)

    def select(self, requests: Iterable[Any], context: Any) -> Iterator[Any]:
        """The tests that are the likeliest to fail, in the order in which they came."""
        tests = list(requests)
        if tests:
            for i in self.weighing.worth(self._signs(tests)):
                yield message("SelectionReply")(testId=tests[i].testId)

    def prioritize(self, requests: Iterable[Any], context: Any) -> Iterator[Any]:
        """All tests, the likeliest to fail first."""
        tests = list(requests)
        if tests:
            for i in order(self.weighing.scores(self._signs(tests))):
                yield message("PrioritizationReply")(testId=tests[i].testId)

    def _signs(self, tests: Iterable[Any]) -> list[Signs]:
        """Of each test."""
        return [signs_of(points_of(test)) for test in tests]


def points_of(test: Any) -> list[tuple[float, float]]:
    """A test's points, in the order of their numbers."""
    points = sorted(test.roadPoints, key=lambda point: point.sequenceNumber)
    return [(point.x, point.y) for point in points]


def serve(host: str, port: int) -> tuple[Any, int]:
    """A server that has started, and its port: one that is free for port 0.

    Raises:
        UsageError: the port cannot be had.
    """
    service = Service()
    server = grpc.server(ThreadPoolExecutor(WORKERS))
    server.add_generic_rpc_handlers((handlers(service),))
    try:
        got = server.add_insecure_port(f"{host}:{port}")
    except RuntimeError:
        got = 0
    if not got:
        raise UsageError(f"cannot listen on {host}:{port}; is something else there? Say another --port")
    server.start()
    return server, got


def handlers(service: Service) -> Any:
    """The RPCs of a service, as gRPC takes them."""
    return grpc.method_handlers_generic_handler(SERVICE, {name: _handler(service, name) for name in METHODS})


def _handler(service: Service, name: str) -> Any:
    request, takes_many, reply, gives_many = METHODS[name]
    kinds = {
        (False, False): grpc.unary_unary_rpc_method_handler,
        (True, False): grpc.stream_unary_rpc_method_handler,
        (True, True): grpc.stream_stream_rpc_method_handler,
    }
    return kinds[takes_many, gives_many](
        getattr(service, name.lower()),
        request_deserializer=message(request).FromString,
        response_serializer=message(reply).SerializeToString,
    )
