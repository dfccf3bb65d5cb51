"""What can go wrong, said as advice: every message tells what is wrong and what to do."""


class RoadGPTError(Exception):
    """Base of all errors that a user can cause or cure; its text is one clear sentence."""

    exit_status = 1


class UsageError(RoadGPTError):
    """Something that the user typed, or a file that they gave, cannot be used."""

    exit_status = 2


class BriefError(UsageError):
    """A description that is nonsense, contradicts itself or asks for the impossible."""


class EditError(UsageError):
    """A change request that cannot be read, names what is not on the road, or cannot be met."""


class DesignError(RoadGPTError):
    """No road could be designed that keeps every promise of the Brief on this map."""

    exit_status = 3


class DriverError(RoadGPTError):
    """A driver raised, returned something that is not a command, or hung."""


class SimulationError(RoadGPTError):
    """No drive came of it: the physics broke down, or the simulator failed."""


class SimulatorError(SimulationError):
    """The simulator itself failed: it could not be started, went away, or gave no answer."""


class GivenUpError(RoadGPTError):
    """A simulator that failed again and again is not asked any more."""

    exit_status = 5

    def __init__(self, why: str, again: str) -> None:
        super().__init__(why, again)
        self.why, self.again = why, again

    def __str__(self) -> str:
        return f"{self.why}; {self.again}"


class PartError(UsageError):
    """A part was asked for by a name that no installed package registers."""


class ExportError(RoadGPTError):
    """A format cannot hold this road, what it needs is not installed, or its file cannot be written."""


class LearnError(UsageError):
    """Pairs of descriptions and plans, or a grammar of phrases, that cannot be used."""


class ChatError(RoadGPTError):
    """A language model's server could not be reached, or did not do what it was asked for."""

    exit_status = 4


class BudgetError(ChatError):
    """The next question would pass the limit of tokens or money that the campaign was given."""


class ReplyError(ChatError):
    """The server answered, but not with what was asked for: costs one road, not the campaign."""

    def __init__(self, sentence: str, text: str = "") -> None:
        super().__init__(sentence)
        self.text = text[:2000]
        """What the model wrote, cut after 2,000 characters; to be looked at, never to be trusted."""


class RefusedError(ReplyError):
    """The model declined to answer."""


class UnparsableError(ReplyError):
    """No reply fits the schema that was asked for, in whatever way it was asked for."""
