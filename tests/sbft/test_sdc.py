"""The SDC service over loopback, asked by a client that gRPC's own compiler made from competition.proto."""

import importlib
import math
import subprocess
import sys
import time
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import grpc
import numpy as np
import pytest
from google.protobuf import descriptor_pb2
from grpc_tools import protoc

from roadgpt.drive import simulate
from roadgpt.drive.drivers.beamng_like import BeamngLike
from roadgpt.road import CrossSection, Road, World
from roadgpt_sbft.sdc import service as our_service
from roadgpt_sbft.sdc.risk import PLAIN, RiskFeatures, fit_model, risk_features
from roadgpt_sbft.sdc.service import serve

PROTO = Path(our_service.__file__).with_name("competition.proto")


@pytest.fixture(scope="module")
def client(tmp_path_factory: pytest.TempPathFactory) -> Iterator[tuple[Any, Any]]:
    """(compiled messages, a stub that is connected to a service of ours)"""
    folder = tmp_path_factory.mktemp("compiled")
    words = [
        "protoc",
        f"-I{PROTO.parent}",
        f"--python_out={folder}",
        f"--grpc_python_out={folder}",
        PROTO.name,
    ]
    assert protoc.main(words) == 0
    sys.path.insert(0, str(folder))
    try:
        compiled = importlib.import_module("competition_pb2")
        stubs = importlib.import_module("competition_pb2_grpc")
    finally:
        sys.path.remove(str(folder))
    server, port = serve("127.0.0.1", 0)
    with grpc.insecure_channel(f"127.0.0.1:{port}") as channel:
        yield compiled, stubs.CompetitionToolStub(channel)
    server.stop(0).wait()


def arc(radius: float, degrees: float = 90.0) -> list[tuple[float, float]]:
    """Straight, a bend to the left, straight; 2 m apart."""
    points = [(2.0 * i, 0.0) for i in range(20)]
    steps = max(2, round(math.radians(degrees) * radius / 2))
    angles = [math.radians(degrees) * i / steps for i in range(steps + 1)]
    points += [(40 + radius * math.sin(a), radius - radius * math.cos(a)) for a in angles]
    (x, y), a = points[-1], angles[-1]
    return points + [(x + 2 * i * math.cos(a), y + 2 * i * math.sin(a)) for i in range(1, 20)]


def case_of(compiled: Any, name: str, points: list[tuple[float, float]], shuffled: bool = False) -> Any:
    made = [compiled.RoadPoint(sequenceNumber=i, x=x, y=y) for i, (x, y) in enumerate(points)]
    return compiled.SDCTestCase(testId=name, roadPoints=made[::-1] if shuffled else made)


def test_the_table_says_what_the_file_says(tmp_path: Path) -> None:
    out = tmp_path / "set"
    words = ["protoc", f"-I{PROTO.parent}", f"--descriptor_set_out={out}", PROTO.name]
    assert protoc.main(words) == 0
    (compiled,) = descriptor_pb2.FileDescriptorSet.FromString(out.read_bytes()).file
    ours = our_service.description()
    for file in (compiled, ours):
        for message in file.message_type:
            for field in message.field:
                field.ClearField("json_name")
    assert {m.name: m for m in compiled.message_type} == {m.name: m for m in ours.message_type}
    for theirs, own in zip(compiled.service[0].method, ours.service[0].method, strict=True):
        theirs.ClearField("options")
        assert theirs == own
    assert compiled.service[0].name == ours.service[0].name
    assert not compiled.package


def test_it_says_its_name(client: tuple[Any, Any]) -> None:
    compiled, stub = client
    assert stub.Name(compiled.Empty()).name == "RoadGPT"


def test_tests_come_back_the_likeliest_to_fail_first(client: tuple[Any, Any]) -> None:
    compiled, stub = client
    roads = {"gentle": arc(120, 20), "sharp": arc(16), "straight": arc(1e5, 0.01), "medium": arc(45, 60)}
    asked = [case_of(compiled, name, points) for name, points in roads.items()]
    answer = [reply.testId for reply in stub.Prioritize(iter(asked))]
    assert sorted(answer) == sorted(roads)
    assert answer[0] == "sharp"
    assert answer.index("medium") < answer.index("straight")
    chosen = [reply.testId for reply in stub.Select(iter(asked))]
    assert "sharp" in chosen
    assert "straight" not in chosen


def test_every_test_is_answered_whatever_its_road(client: tuple[Any, Any]) -> None:
    compiled, stub = client
    roads = {
        "none": [],
        "one": [(1.0, 1.0)],
        "same": [(5.0, 5.0)] * 4,
        "double": [(0.0, 0.0), (30.0, 0.0), (30.0, 0.0), (60.0, 1.0)],
        "nan": [(0.0, 0.0), (math.nan, 3.0), (9.0, 9.0)],
        "huge": [(0.0, 0.0), (3e38, 3e38)],
        "tiny": [(0.0, 0.0), (1.0, 0.0)],
        "knot": [(0.0, 0.0), (20.0, 0.0), (0.0, 1.0), (20.0, 1.0), (0.0, 2.0)],
    }
    asked = [case_of(compiled, name, points) for name, points in roads.items()]
    assert sorted(reply.testId for reply in stub.Prioritize(iter(asked))) == sorted(roads)
    assert [reply.testId for reply in stub.Prioritize(iter([]))] == []
    assert [reply.testId for reply in stub.Select(iter([]))] == []
    assert len([*stub.Select(iter(asked[:3]))]) >= 1


def test_it_learns_from_known_outcomes(client: tuple[Any, Any]) -> None:
    compiled, stub = client
    # An odd car, which fails on gentle roads only: only what is told can say so.
    oracles = [
        compiled.Oracle(testCase=case_of(compiled, f"{radius}", arc(radius, 40)), hasFailed=radius > 60)
        for radius in np.linspace(20, 100, 24).tolist()
    ]
    try:
        assert stub.Initialize(iter(oracles)).ok
        asked = [case_of(compiled, name, arc(radius, 40)) for name, radius in (("a", 25.0), ("b", 95.0))]
        assert [reply.testId for reply in stub.Prioritize(iter(asked))] == ["b", "a"]
        assert [reply.testId for reply in stub.Select(iter(asked))] == ["b"]
    finally:
        assert stub.Initialize(iter([])).ok
    assert [reply.testId for reply in stub.Prioritize(iter(asked))] == ["a", "b"]


def test_what_is_selected_fails_far_more_often_than_what_is_not() -> None:
    # As rare and as hard to foretell as recorded: 8 % fail, and the best sign tells little.
    rng = np.random.default_rng(11)
    shares, counts, misses = [], [], 0
    for _ in range(40):
        table = rng.normal(size=(1500, len(RiskFeatures._fields)))
        failed = rng.random(1500) < 1 / (1 + np.exp(3.0 - 0.9 * table[:, 0]))
        features = [RiskFeatures(*row) for row in table]
        model = fit_model(features[:1200], failed[:1200].tolist())
        chosen = failed[1200:][model.select(features[1200:])]
        shares.append(chosen.mean())
        counts.append(len(chosen))
        misses += not chosen.any()
    assert np.mean(shares) > 2.5 * failed.mean()
    assert max(counts) <= 40
    assert misses <= 2  # the evaluator divides by the failures that were found


def test_a_hundred_tests_are_ordered_in_far_less_than_four_seconds(client: tuple[Any, Any]) -> None:
    compiled, stub = client
    radii = np.linspace(15, 150, 100).tolist()
    asked = [case_of(compiled, f"{radius}", arc(radius, 300)) for radius in radii]
    begun = time.process_time()
    answer = [float(reply.testId) for reply in stub.Prioritize(iter(asked))]
    assert time.process_time() - begun < 4  # the service's threads are of this process
    assert sorted(answer) == radii
    assert answer[0] < 40 < 100 < answer[-1]


@pytest.mark.parametrize(
    ("world", "middle"),
    [(PLAIN, -2.0), (PLAIN.changed(lane_width=3.0), -1.5), (World(section=CrossSection(lanes="2+1")), -6.0)],
)
def test_the_line_is_where_the_car_drives(world: World, middle: float) -> None:
    road = Road.through(arc(30))
    drive = simulate(road, world, BeamngLike(), keep_driving=True)
    s, t = drive["s"], drive["t"]
    counts = (s > 25) & (s < road.length - 8)
    farthest = np.abs(t[counts] - middle).max()
    assert risk_features(arc(30), world).near == pytest.approx(farthest, abs=0.6)


def test_the_command_serves_until_it_is_stopped() -> None:
    code = "from roadgpt.cli import main; main()"
    command = [sys.executable, "-c", code, "compete", "sdc", "--port", "0"]
    process = subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
    try:
        assert process.stdout is not None
        said = process.stdout.readline()
        address = said.removeprefix("listening on ").strip()
        with grpc.insecure_channel(address) as channel:
            ask = channel.unary_unary(
                "/CompetitionTool/Name",
                request_serializer=our_service.message("Empty").SerializeToString,
                response_deserializer=our_service.message("NameReply").FromString,
            )
            assert ask(our_service.message("Empty")(), timeout=30).name == "RoadGPT"
    finally:
        process.terminate()
        process.communicate(timeout=30)
