"""What a generator's executor counts, under the competition's names."""

from dataclasses import dataclass, field

COLUMNS = (
    "test_generated",
    "test_valid",
    "test_invalid",
    "test_passed",
    "test_failed",
    "test_in_error",
)
TIMES = ("real_time_generation", "real_time_execution", "simulated_time_execution")


@dataclass
class TestGenerationStatistic:
    """Counts of tests by what became of them, and seconds of each."""

    __test__ = False  # pytest is not to collect it, for all its name

    test_generated: int = 0
    test_valid: int = 0
    test_invalid: int = 0
    test_passed: int = 0
    test_failed: int = 0
    test_in_error: int = 0
    obes: int = 0
    """Tests that failed out of the lane."""
    test_generation_real_times: list[float] = field(default_factory=list)
    test_execution_real_times: list[float] = field(default_factory=list)
    test_execution_simulation_times: list[float] = field(default_factory=list)

    def add(self, outcome: str, description: str) -> None:
        """Count a test."""
        self.test_generated += 1
        if outcome == "INVALID":
            self.test_invalid += 1
            return
        self.test_valid += 1
        self.test_passed += outcome == "PASS"
        self.test_failed += outcome == "FAIL"
        self.test_in_error += outcome == "ERROR"
        self.obes += outcome == "FAIL" and description.startswith("Car drove out of the lane")

    def _row(self) -> dict[str, float]:
        times = (
            self.test_generation_real_times,
            self.test_execution_real_times,
            self.test_execution_simulation_times,
        )
        counts = {name: float(getattr(self, name)) for name in COLUMNS}
        return counts | {name: sum(seconds) for name, seconds in zip(TIMES, times, strict=True)}

    def __str__(self) -> str:
        return "\n".join(f"{name.replace('_', ' ')}: {value:g}" for name, value in self._row().items())

    def as_csv(self) -> str:
        """The competition's generation_stats.csv."""
        row = self._row()
        return ",".join(row) + "\n" + ",".join(f"{value:g}" for value in row.values())
