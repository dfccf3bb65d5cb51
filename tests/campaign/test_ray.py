"""A real Ray cluster of two nodes, one of which is killed in the middle: nothing is lost, nothing doubled."""

from collections.abc import Iterator
from importlib.util import find_spec
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from campaign import jobs, quick
from campaign.jobs import TESTS
from roadgpt.campaign.executors import LostWorkerError, Shared, WorkerConfig
from roadgpt.campaign.lifecycle import begin, work
from roadgpt.errors import RoadGPTError, UsageError

pytestmark = pytest.mark.skipif(
    find_spec("ray") is None, reason="Ray is not installed: pip install 'roadgpt[ray]'"
)
SOON = 120.0  # s: far more than anything here takes


@pytest.fixture(scope="module")
def cluster() -> Iterator[Any]:
    """One node with three cores; a test may add another, and kill it."""
    from ray.cluster_utils import Cluster

    with pytest.MonkeyPatch.context() as patch:
        patch.setenv("PYTHONPATH", str(TESTS))  # for the nodes' workers
        patch.setenv("RAY_health_check_period_ms", "500")
        patch.setenv("RAY_health_check_failure_threshold", "3")
        small = {"object_store_memory": 80_000_000, "include_dashboard": False, "no_monitor": True}
        made = Cluster(initialize_head=True, head_node_args={"num_cpus": 3, **small})
        made.small = small
        try:
            yield made
        finally:
            made.shutdown()


@pytest.fixture
def hands(cluster: Any, tmp_path: Path) -> Iterator[Any]:
    from roadgpt.campaign.executors.ray import Ray

    made = Ray(WorkerConfig(2, jobs.nothing, 2.0, tmp_path / "log", cluster.address))
    yield made
    made.shutdown(cancel_futures=True)
    import ray

    assert not ray.is_initialized()


def test_results_values_and_errors_come_back_and_who_kills_is_found(
    hands: Any, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("roadgpt.campaign.workers.MOST_DEATHS", 1)  # each takes seconds
    from ray._common.usage.usage_lib import usage_stats_enabled

    from roadgpt.campaign.executors.ray import Ray

    assert not usage_stats_enabled()  # Ray's own word that it reports to nobody
    assert [*hands.map(jobs.square, range(50))] == [number * number for number in range(50)]
    with pytest.raises(ValueError, match="no number 3"):
        [*hands.map(jobs.fails_at_three, range(5))]
    hundred, seven = Shared(100), Shared(7)
    done = [hands.submit(jobs.plus, key, hundred) for key in range(40)]
    assert [each.result(SOON) for each in done] == [key + 100 for key in range(40)]
    odd = [jobs.fails_at_three, jobs.unanswerable, jobs.raises_what_cannot_travel, jobs.dies]
    fails, unanswerable, heavy, dies = (hands.submit(function, 3) for function in odd)
    hangs = hands.submit(jobs.sleeps, 300)
    rest = [hands.submit(jobs.plus, 3, seven) for _ in range(35)]
    assert isinstance(fails.exception(SOON), ValueError)
    assert unanswerable.exception(SOON) is not None
    assert "cannot travel" in str(heavy.exception(SOON))
    for lost, how in ((dies, "ended: "), (hangs, "took longer than 2 s")):
        assert isinstance(lost.exception(SOON), LostWorkerError)
        assert str(lost.exception()).startswith(f"given up: 1 workers ended over it (the last one {how}")
    assert {each.result(SOON) for each in rest} == {10}
    refusing = Ray(WorkerConfig(1, jobs.refuses, 3.0, tmp_path / "log"))
    with pytest.raises(UsageError, match="there is no driver of that name"):
        refusing.submit(jobs.square, 1).result(SOON)
    refusing.shutdown(cancel_futures=True)


def test_a_node_is_killed_in_the_middle_and_the_table_is_that_of_one_process(
    cluster: Any, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    quick.put_on_shelves(monkeypatch.setattr, seconds=0.05)
    quick.Inline.rng = np.random.default_rng(0)
    monkeypatch.setattr("roadgpt.campaign.record.Store.group_seconds", 0.2)
    tables = []
    for executor in ("inline", "ray"):
        folder = tmp_path / executor
        begin(quick.plan(40, seconds=0.05), folder)
        second = cluster.add_node(num_cpus=1, **cluster.small) if executor == "ray" else None
        address = cluster.address if second else ""
        counts = []
        for progress in work(folder, 3, executor, address):
            counts.append(progress.total())
            if second and progress.total() >= 10:
                cluster.remove_node(second, allow_graceful=False)
                second = None
        assert counts[-1] == 40
        tables.append((folder / "results.csv").read_bytes())
    assert tables[0] == tables[1]


def test_a_cluster_that_does_not_answer_is_told_in_a_sentence(tmp_path: Path) -> None:
    from roadgpt.campaign.executors.ray import Ray

    with pytest.raises(RoadGPTError, match=r"no Ray cluster answers at 127\.0\.0\.1:1 .*ray start --head"):
        Ray(WorkerConfig(1, jobs.nothing, 3.0, tmp_path / "log", "127.0.0.1:1"))
