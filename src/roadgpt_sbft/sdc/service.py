"""Serves the competition's evaluator over gRPC."""

import logging
from collections.abc import Iterable, Iterator
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path
from typing import Any

import grpc
from google.protobuf import descriptor_pb2, descriptor_pool, message_factory, text_format

from roadgpt.errors import UsageError
from roadgpt_sbft.sdc.risk import LINE_ONLY, RiskFeatures, fit_model, order, risk_features

log = logging.getLogger(__name__)

NAME = "RoadGPT"
MOST_OUTCOMES = 5000  # known outcomes that are used; they take about 6 s of processor time
WORKERS = 4
SERVICE = "CompetitionTool"
HANDLERS = {
    (False, False): grpc.unary_unary_rpc_method_handler,
    (True, False): grpc.stream_unary_rpc_method_handler,
    (True, True): grpc.stream_stream_rpc_method_handler,
}


def description() -> Any:
    """Returns ``competition.proto`` as a protobuf file descriptor."""
    text = Path(__file__).with_name("competition.textproto").read_text("utf-8")
    return text_format.Parse(text, descriptor_pb2.FileDescriptorProto())


_POOL = descriptor_pool.DescriptorPool()
_POOL.AddSerializedFile(description().SerializeToString())
METHODS = _POOL.FindServiceByName(SERVICE).methods


def message(name: str) -> Any:
    """Returns the class of the message with this name."""
    return message_factory.GetMessageClass(_POOL.FindMessageTypeByName(name))


class Service:
    """Serves one client, the competition's evaluator; each public method is a remote procedure call (RPC)."""

    def __init__(self) -> None:
        self.model = LINE_ONLY

    def name(self, request: Any, context: Any) -> Any:
        """Returns the name of the tool."""
        return message("NameReply")(name=NAME)

    def initialize(self, requests: Iterable[Any], context: Any) -> Any:
        """Fits the risk model to the received tests and outcomes; of more than 5000, to every n-th."""
        oracles = list(requests)
        chosen = oracles[:: max(1, -(-len(oracles) // MOST_OUTCOMES))]
        features = [_features_of(oracle.testCase) for oracle in chosen]
        self.model = fit_model(features, [bool(oracle.hasFailed) for oracle in chosen])
        log.info("%d of %d known outcomes were used", len(chosen), len(oracles))
        return message("InitializationReply")(ok=True)

    def select(self, requests: Iterable[Any], context: Any) -> Iterator[Any]:
        """Yields the ids of the tests most likely to fail, in the order in which they were received."""
        tests = list(requests)
        if tests:
            for i in self.model.select([*map(_features_of, tests)]):
                yield message("SelectionReply")(testId=tests[i].testId)

    def prioritize(self, requests: Iterable[Any], context: Any) -> Iterator[Any]:
        """Yields the ids of all tests, from the most to the least likely to fail."""
        tests = list(requests)
        if tests:
            for i in order(self.model.scores([*map(_features_of, tests)])):
                yield message("PrioritizationReply")(testId=tests[i].testId)


def _features_of(test: Any) -> RiskFeatures:
    points = sorted(test.roadPoints, key=lambda point: point.sequenceNumber)
    return risk_features([(point.x, point.y) for point in points])


def serve(host: str, port: int) -> tuple[Any, int]:
    """Starts a server; returns the server and its port. If ``port`` is 0, any free port is used."""
    service = Service()
    server = grpc.server(ThreadPoolExecutor(WORKERS))
    handlers = {
        method.name: HANDLERS[method.client_streaming, method.server_streaming](
            getattr(service, method.name.lower()),
            request_deserializer=message(method.input_type.name).FromString,
            response_serializer=message(method.output_type.name).SerializeToString,
        )
        for method in METHODS
    }
    server.add_generic_rpc_handlers((grpc.method_handlers_generic_handler(SERVICE, handlers),))
    try:
        got = server.add_insecure_port(f"{host}:{port}")
    except RuntimeError:
        got = 0
    if not got:
        raise UsageError(f"cannot listen on {host}:{port}; if another program uses it, choose another --port")
    server.start()
    return server, got
