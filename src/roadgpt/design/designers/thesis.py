"""The method of RoadGPT's thesis, unchanged, as a baseline for comparisons.

The model gets one request with the thesis' system prompt and answers once in JSON; there is no second request
and no repair. The road is the spline through the ends of the segments; it may be invalid. Source: sections
5.3.1 and 5.3.2 of the thesis. The prompt is paraphrased. Where it contradicts itself or the thesis' program,
this designer does the following:

* theta 0 is "along the y axis" in the prompt and +x in the program: +x is used;
* x and y end at 200 in the prompt and at 250 in the checks, "to offer a bit of flexibility": here the
  prompt states 0.8 times the side length of the map;
* right turns are negative in the prompt, but its own example has a left turn of -20: the field ``direction``
  decides;
* the program begins with 5 m of level road, which is kept, and shifts the start by (5, 5), which is omitted.

The thesis' program passed answers, which were Python dictionaries, to ``eval``; here answers are JSON."""

from collections.abc import Sequence
from importlib.resources import files

from roadgpt.brief.model import Brief
from roadgpt.brief.sentence import sentence
from roadgpt.chat import Chat, ChatSettings, Message, UnparsableError, configured, open_chat
from roadgpt.chat.answer import NotReadableError, read_object
from roadgpt.design import DesignReport
from roadgpt.errors import UsageError
from roadgpt.road import Design, Geometry, World, build, read_design

RULES = "thesis_rules.txt"
MOST_WORDS = 2000  # characters of a description


class ThesisDesigner:
    """A designer that works as in RoadGPT's thesis: it sends one request and uses the answer unchanged."""

    redrafts = False
    """False: an invalid road counts as invalid and is not drafted again."""
    geometry: Geometry = "spline"

    def __init__(self, settings: ChatSettings | None = None, chat: Chat | None = None) -> None:
        self._settings = settings or configured()
        self._chat = chat
        self.report: DesignReport | None = None

    def draft(
        self, brief: Brief, world: World, notes: tuple[str, ...], earlier: Sequence[Design], seed: int
    ) -> Design:
        """Returns the Design that the model answers with; ``notes``, ``earlier`` and ``seed`` are not used.
        Raises ReplyError if the answer is not a design, and ChatError if the model could not be asked."""
        self.report = None
        chat = self._chat = self._chat or open_chat(self._settings)
        before = chat.spent
        asked = [
            Message(role="system", text=_rules(world)),
            Message(role="user", text=brief.words.strip()[:MOST_WORDS] or sentence(brief)),
        ]
        reply = chat.ask(asked)
        try:
            design, remarks = read_design(read_object(reply.text))
            build(design, self.geometry)  # raises an error if nodes coincide
        except (NotReadableError, UsageError) as error:
            raise UnparsableError(f"the answer of the model is no road: {error}", reply.text) from None
        spent = chat.spent.since(before)
        self.report = DesignReport(
            rounds=1,
            changes=remarks,
            tokens=spent.usage,
            seconds=spent.seconds,
            cost=spent.cost,
            model=reply.model,
            proposed=design.to_json(),
        )
        return design


def _rules(world: World) -> str:
    text = files("roadgpt.design.designers").joinpath(RULES).read_text(encoding="utf-8")
    return text.format(bound=f"{0.8 * world.site.map_size:g}", floor=f"{world.site.z_floor:g}")
