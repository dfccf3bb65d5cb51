"""The chat designer: a language model designs the road and corrects it after objections.

The model gets the Brief, the rules of the map and a list of earlier roads. Its proposal is repaired as far as
the settings allow: the road is moved onto the map, then changed as little as needed (``repair``). A route
with junctions is only moved; see ``design.network_dialogue``, which is imported only where it is used.
"""

from collections.abc import Sequence

from roadgpt.brief.model import Brief
from roadgpt.chat import Chat, ChatSettings, configured, open_chat
from roadgpt.design.answer import AnswerRoad
from roadgpt.design.asking import request, rules
from roadgpt.design.dialogue import DesignTask, judged_road, stepwise, whole
from roadgpt.design.differences import changes_between
from roadgpt.design.report import DesignReport
from roadgpt.design.variety import ENOUGH, Shapes, nearest, shape_of
from roadgpt.errors import DesignError
from roadgpt.network import NetworkDesign
from roadgpt.road import Design, World, build

RULES = "chat_rules.txt"


class ChatDesigner:
    """A designer that asks a language model, in one or more rounds."""

    redrafts = False
    """False: this designer itself asks the model for corrections, so it is not called again if its draft
    violates a rule.
    """
    makes_junctions = True

    def __init__(self, settings: ChatSettings | None = None, chat: Chat | None = None) -> None:
        self._settings = settings or configured()
        self._chat = chat
        self._shapes = Shapes()
        self.report: DesignReport | None = None

    def draft(
        self, brief: Brief, world: World, notes: tuple[str, ...], earlier: Sequence[Design], seed: int
    ) -> Design | NetworkDesign:
        """Returns the best Design of all rounds, or NetworkDesign for a network, even if it is not valid.

        The road should differ from all ``earlier`` designs; for networks, these are ignored. The seed
        determines the start that is suggested to the model.

        Raises:
            DesignError: no answer was a road, the Brief asks for a map of roads, or the settings ask for a
                route segment by segment.
            ReplyError: no answer could be read.
            UsageError: the World has lanes or banked bends that networks do not have.
            ChatError: the model could not be asked.
        """
        self.report = None
        if brief.map is not None:
            raise DesignError(
                "this designer makes roads and routes with junctions, but no maps of roads; leave --designer "
                "out (with --reader chat, the model still reads the description)"
            )
        chat = self._chat = self._chat or open_chat(self._settings)
        before = chat.spent
        task = DesignTask(
            brief,
            world,
            self._settings,
            rules(RULES, world),
            request(brief, world, notes, () if brief.is_of_network else earlier, seed),
            lambda design: self._is_new(design, earlier),
            seed,
        )
        if brief.is_of_network:
            from roadgpt.design.network_dialogue import route_outcome  # a single road does not need it

            outcome = route_outcome(chat, task)
        elif self._settings.strategy == "stepwise":
            outcome = stepwise(chat, task)
        else:
            outcome = whole(chat, task, AnswerRoad, judged_road)
        spent = chat.spent.since(before)
        self.report = DesignReport(
            rounds=outcome.questions,
            changes=(*outcome.remarks, *changes_between(outcome.proposed, outcome.design)),
            tokens=spent.usage,
            seconds=spent.seconds,
            cost=spent.cost,
            model=outcome.model,
            proposed=outcome.proposed.to_json(),
        )
        return outcome.design

    def _is_new(self, design: Design, earlier: Sequence[Design]) -> bool:
        if not earlier:
            return True
        samples = build(design).sample()
        shape = shape_of(samples.s, samples.x + 1j * samples.y)
        return nearest(shape, self._shapes.of(earlier), by_metres=False) >= ENOUGH
