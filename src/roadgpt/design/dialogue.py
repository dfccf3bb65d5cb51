"""Holds the dialogue in which a language model designs a road, either as a whole or segment by segment.

Every proposal is repaired as far as the settings allow, and then checked. Sentences that say what is still
wrong are sent back to the model. Every request to the model is counted.
"""

import json
from collections.abc import Callable, Sequence
from typing import NamedTuple, TypeVar

from pydantic import BaseModel

from roadgpt.brief.model import Brief
from roadgpt.chat import Chat, ChatSettings, Message, ReplyError, UnparsableError
from roadgpt.chat.model import Repair
from roadgpt.design.answer import AnswerRoad, AnswerStart, AnswerStep, design_of
from roadgpt.design.asking import USUAL_HEIGHT, drawn_start, listed, objections
from roadgpt.design.repair import repair
from roadgpt.errors import DesignError, UsageError
from roadgpt.network import NetworkDesign
from roadgpt.road import Design, World, build

MOST_SHOWN = 6000  # characters of its own answer that a model gets again
MOST_SEGMENTS = 40  # of a road that is designed segment by segment
MOST_MENDED = 4  # segments for which others may be changed; more are not tried
MOST_LEFT_OUT = 2  # consecutive segments that could not be placed, after which the road ends
Answer = TypeVar("Answer", bound=BaseModel)


class DesignTask(NamedTuple):
    """The design of one road or route, as a task for a language model."""

    brief: Brief
    world: World
    settings: ChatSettings
    rules: str
    """The system message, with the rules of the map."""
    question: str
    """The first message of the user, with the requirements."""
    is_new: Callable[[Design], bool]
    """A function that returns whether a design differs from all earlier ones of the campaign."""
    seed: int
    """Seed of the random start that is used if the model gives no start."""


class Outcome(NamedTuple):
    """The result of a dialogue with a language model."""

    design: Design | NetworkDesign
    """The road or route, after repairs."""
    proposed: Design | NetworkDesign
    """The road or route as the model proposed it."""
    questions: int
    """Number of requests to the model."""
    objections: tuple[str, ...]
    """Sentences that say what is still wrong with the road."""
    remarks: tuple[str, ...] = ()
    """Sentences that say what was corrected in the answers, and what was omitted."""
    model: str = ""
    """Name of the model as reported by its server."""


Judge = Callable[[Answer, DesignTask, int, str], Outcome]
"""A function that makes and checks the design of an answer. It gets the answer, the task, the number of
requests so far, and the name of the model; it raises UsageError if the answer is not a design."""


def whole(chat: Chat, task: DesignTask, form: type[Answer], judge: Judge[Answer]) -> Outcome:
    """Asks for whole roads until one is free of errors or all rounds are used up; returns the best one.

    Raises:
        DesignError: no answer was a road.
        ReplyError: no answer could be read.
        ChatError: the model could not be asked.
    """
    opening = [Message(role="system", text=task.rules), Message(role="user", text=task.question)]
    messages, best = opening, list[Outcome]()
    problem: Exception | None = None
    wrong: tuple[str, ...]
    for number in range(1, task.settings.rounds + 1):
        try:
            reply = chat.ask(messages, form)
            outcome = judge(reply.data, task, number, reply.model)
        except UnparsableError as error:
            problem, said, wrong = error, error.text, (f"it could not be read: {error}",)
        except UsageError as error:
            problem, said, wrong = error, _compact(reply.data), (str(error),)
        except ReplyError:
            if not best:
                raise
            break
        else:
            best = sorted([*best, outcome], key=lambda one: len(one.objections))[:1]
            wrong = outcome.objections
            if not wrong:
                break
            said = _compact(reply.data)
        messages = [
            *opening,
            Message(role="assistant", text=said or "(nothing)"),
            Message(
                role="user",
                text=f"This road will not do:\n{listed(wrong)}\nGive the whole road again, mended.",
            ),
        ]
    if best:
        return best[0]._replace(questions=number)
    if isinstance(problem, ReplyError):
        raise problem
    raise DesignError(f"no answer of the model was a road: {problem}; try again, or use another model")


def judged_road(answer: AnswerRoad, task: DesignTask, number: int, model: str) -> Outcome:
    """Returns the road of an answer, repaired, and what is still wrong with it.

    Raises:
        UsageError: the answer is not a road.
    """
    proposed, remarks = design_of(answer, answer.segments)
    build(proposed)  # raises UsageError if the road is too long
    design = repair(proposed, task.brief, task.world, task.settings.repair).design
    wrong = objections(design, task.brief, task.world)
    if not wrong and not task.is_new(design):
        wrong = ("the road is like an earlier one of this campaign; change its turns and lengths",)
    return Outcome(design, proposed, number, wrong, remarks, model)


def _compact(answer: BaseModel) -> str:
    return json.dumps(answer.model_dump(exclude_none=True), separators=(",", ":"))[:MOST_SHOWN]


def stepwise(chat: Chat, task: DesignTask) -> Outcome:
    """Asks for one segment at a time and checks each before it asks for the next.

    The model may try each segment as often as the setting ``rounds`` allows. If the last try is rejected as
    well, the segment is omitted, so the dialogue always ends.

    Raises:
        DesignError: no answer was a segment that can be placed.
        ReplyError: no answer could be read.
        ChatError: the model could not be asked.
    """
    return _Steps(chat, task).walked()


class _Steps:
    """The road so far, and the conversation about it."""

    def __init__(self, chat: Chat, task: DesignTask) -> None:
        self.chat, self.task = chat, task
        self.questions = 0
        self.model = ""
        self.remarks: list[str] = []
        self.steps: list[AnswerStep] = []
        self.how: Repair = "none" if task.settings.repair == "none" else "place"
        self.mended = 0
        self.road: Design | None = None
        """The steps so far, repaired."""
        self.problem: Exception | None = None
        x, y, theta = drawn_start(task.world, task.seed)
        self.start = AnswerStart(starting_point=[x, y, USUAL_HEIGHT], theta=theta)

    def walked(self) -> Outcome:
        """Asks for segments until the model says that the road is finished, or until no more can be added;
        returns the road.
        """
        self._begin()
        tries, left_out, endings = 0, 0, 0
        wrong: tuple[str, ...] = ()
        while len(self.steps) < MOST_SEGMENTS and left_out < MOST_LEFT_OUT:
            try:
                step = self._asked(wrong)
            except UnparsableError as error:
                self.problem, wrong = error, (f"it could not be read: {error}",)
            except ReplyError as error:  # the model declines: the road ends here
                self.problem = error
                break
            else:
                wrong = self._added(step, self.how)
                if wrong and tries + 1 == self.task.settings.rounds:  # rather than leave the segment out
                    wrong = self._added(step, self.task.settings.repair)
                if not wrong:
                    tries = left_out = 0
                    if step.last:
                        endings += 1
                        wrong = self._ended()
                        if not wrong or endings == self.task.settings.rounds:
                            break
                    continue
            tries += 1
            if tries == self.task.settings.rounds:
                self.remarks.append(f"segment {len(self.steps) + 1} was left out: {wrong[0]}")
                tries, left_out = 0, left_out + 1
        return self._outcome()

    def _begin(self) -> None:
        """Sets the start to the model's answer; keeps the random start if the answer is not on the map."""
        try:
            reply = self.chat.ask(self._messages("Give the start of the road."), AnswerStart)
            point = reply.data.starting_point
            self.questions, self.model = self.questions + 1, reply.model
            size = self.task.world.site.map_size
            if len(point) in (2, 3) and all(0 <= v <= size for v in point[:2]):
                self.start = reply.data
                return
            self.problem = DesignError("the start lies outside the map")
        except ReplyError as error:
            self.questions, self.problem = self.questions + 1, error
        self.remarks.append(f"the start was drawn: {self.problem}")

    def _messages(self, question: str) -> list[Message]:
        task = f"{self.task.question}\n\n{question}"
        return [Message(role="system", text=self.task.rules), Message(role="user", text=task)]

    def _asked(self, wrong: Sequence[str]) -> AnswerStep:
        """Returns the next segment; ``wrong`` says why the last answer was not accepted."""
        asked = [self._state(), "Give the next segment."]
        if wrong:
            asked.insert(1, f"Your last answer will not do:\n{listed(wrong)}")
        self.questions += 1
        reply = self.chat.ask(self._messages("\n".join(asked)), AnswerStep)
        self.model = reply.model
        step: AnswerStep = reply.data
        return step

    def _state(self) -> str:
        """Returns a text that lists the segments so far, and says where the road ends."""
        if self.road is None:
            x, y = self.start.starting_point[:2]
            return (
                f"The road starts at ({x:g}, {y:g}) with theta {self.start.theta:g}; it has no segment yet."
            )
        design = self.road
        road = build(design)
        x, y, z = (float(v) for v in road.at(road.length))
        heading = (design.theta + sum(s.turn_degrees for s in design.segments)) % 360
        lines = [
            f"{number}. {s.distance:g} m {s.direction}, turn {s.turn_degrees:g}, incline {s.incline:g}"
            for number, s in enumerate(design.segments, 1)
        ]
        end = f"It has come to ({x:.0f}, {y:.0f}, {z:.0f}) and heads {heading:.0f} degrees."
        return "The road so far:\n" + "\n".join(lines) + f"\n{end}"

    def _finished(self, steps: Sequence[AnswerStep]) -> tuple[Design, tuple[str, ...]]:
        """Returns the repaired road of these steps, and what is still wrong with it."""
        proposed, _ = design_of(self.start, steps)
        design = repair(proposed, self.task.brief, self.task.world, self.task.settings.repair).design
        return design, objections(design, self.task.brief, self.task.world)

    def _added(self, step: AnswerStep, how: Repair) -> tuple[str, ...]:
        """Adds a segment to the road and returns (), or returns sentences that say why it was not added."""
        self.mended += how == "full"
        if self.mended > MOST_MENDED:
            return ("there is no room for it",)
        try:
            proposed, _ = design_of(self.start, [*self.steps, step])
            build(proposed)  # raises UsageError if the road is too long
            design = repair(proposed, None, self.task.world, how).design
        except UsageError as error:
            self.problem = error
            return (str(error),)
        wrong = objections(design, None, self.task.world, partly=True)
        if not wrong:
            self.steps.append(step)
            self.road, self.how = design, how
        return wrong

    def _ended(self) -> tuple[str, ...]:
        """Returns what is wrong with the finished road; removes the last segment if less is then wrong."""
        _, wrong = self._finished(self.steps)
        if wrong and len(self.steps) > 1:
            shorter, fewer = self._finished(self.steps[:-1])
            if len(fewer) < len(wrong):
                self.remarks.append(f"segment {len(self.steps)} was taken back: {wrong[0]}")
                self.steps.pop()
                self.road, wrong = shorter, fewer
        return wrong

    def _outcome(self) -> Outcome:
        if not self.steps:
            if isinstance(self.problem, ReplyError):
                raise self.problem
            raise DesignError(
                f"the model gave no segment that can be placed: {self.problem}; use another model"
            )
        proposed, remarks = design_of(self.start, self.steps)
        design, wrong = self._finished(self.steps)
        return Outcome(design, proposed, self.questions, wrong, (*remarks, *self.remarks), self.model)
