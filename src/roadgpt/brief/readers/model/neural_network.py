"""The network behind the model reader: two ONNX graphs, run by onnxruntime on one core."""

from collections.abc import Iterable, Sequence
from copy import copy
from dataclasses import dataclass, replace
from functools import cached_property, lru_cache
from pathlib import Path
from typing import Self

import numpy as np
import numpy.typing as npt

from roadgpt.brief.plan import SCENE
from roadgpt.brief.readers.model.grammar import (
    END,
    Evidence,
    PlanAutomaton,
    any_change,
    change_request,
    description,
    whole,
)
from roadgpt.brief.readers.model.onnx_runtime import onnxruntime
from roadgpt.brief.readers.model.slots import SlottedText
from roadgpt.brief.readers.model.vocabulary import NUMBER_OF, REFUSALS, TOKENS
from roadgpt.errors import PartError
from roadgpt.reading import read_text

UNKNOWN_PIECE = "[UNK]"
LONGEST = 40  # letters; anything longer is not split
WINDOW = 126
"""The largest number of pieces that are encoded together, without the special pieces at the two ends."""
ENDS = frozenset(".;!?")


class WordPieces:
    """Splits words into the pieces of a vocabulary; the number of a piece is its index in the vocabulary."""

    def __init__(self, pieces: Sequence[str]) -> None:
        self.number = {piece: index for index, piece in enumerate(pieces)}
        self._split = lru_cache(maxsize=4096)(self._pieces)

    def encode(self, words: Iterable[str]) -> list[list[int]]:
        """Returns the numbers of all pieces, with a special piece at either end, in chunks of at most
        ``WINDOW`` pieces. A chunk ends with a sentence where one of its two last thirds has the end of one.
        """
        chunks, chunk, sentence = list[list[int]](), list[int](), 0
        for word in words:
            pieces = self._split(word)
            if len(chunk) + len(pieces) > WINDOW:
                cut = sentence if sentence > WINDOW // 3 else len(chunk)
                chunks.append(chunk[:cut])
                chunk, sentence = chunk[cut:], 0
            chunk += pieces[:WINDOW]
            sentence = len(chunk) if word in ENDS else sentence
        first, last = self.number["[CLS]"], self.number["[SEP]"]
        return [[first, *each, last] for each in (*chunks, chunk)]

    def _pieces(self, word: str) -> tuple[int, ...]:
        if word in self.number:
            return (self.number[word],)
        out: list[int] = []
        start = 0
        while start < len(word) <= LONGEST:
            for end in range(len(word), start, -1):
                piece = ("##" if start else "") + word[start:end]
                if piece in self.number:
                    out.append(self.number[piece])
                    start = end
                    break
            else:
                break
        return tuple(out) if out and start == len(word) else (self.number[UNKNOWN_PIECE],)


Array = npt.NDArray[np.float32]
Numbers = npt.NDArray[np.int64]
START = NUMBER_OF["<start>"]
MOST_TOKENS = 90
WIDTH = 4
FAVOUR = 0.3
"""Exponent of the length normalisation: a plan's log-probability is divided by its length to this power."""
LEAST = np.float32(-30)
"""Smaller log-probabilities count as this one, since differences between them say nothing."""
UNKNOWN = np.float32(-1e4)
"""The score of a token that the weights do not know."""
REFUSED = [NUMBER_OF[word] for word in REFUSALS]


@dataclass(frozen=True, slots=True)
class WrittenPlan:
    """A plan that the network writes or has written: its tokens and their probabilities."""

    writer: PlanAutomaton
    """The state of the plan, which determines which tokens may come next."""
    tokens: tuple[str, ...] = ()
    log_chances: tuple[float, ...] = ()
    """The log-probability of each token, including the end token, relative to all tokens allowed at its
    position."""
    is_done: bool = False

    @classmethod
    def of(cls, text: SlottedText, has_scenes: bool) -> Self:
        """Returns an empty plan for a text; ``has_scenes`` is whether the network can write scenes."""
        said = frozenset(word.text for word in text.words)
        changes, told = (any_change, whole) if has_scenes else (change_request, description)
        asked = changes if text.is_change else told
        return cls(PlanAutomaton(text.slots, said, Evidence.of(text.text), asked))

    @property
    def score(self) -> float:
        """The log-probability, normalised for length, because otherwise long plans would score lower."""
        return sum(self.log_chances) / float(max(1, len(self.log_chances)) ** FAVOUR)

    def longer(self, token: int, log_chance: float) -> Self:
        """Returns the plan with one more token."""
        log_chances = (*self.log_chances, log_chance)
        if TOKENS[token] == END:
            return replace(self, log_chances=log_chances, is_done=True)
        writer = copy(self.writer)
        writer.push(TOKENS[token])
        return replace(self, writer=writer, tokens=(*self.tokens, TOKENS[token]), log_chances=log_chances)


class NeuralNetwork:
    """The trained network, which reads a description and writes plans."""

    def __init__(self, folder: Path, name: str = "") -> None:
        """Takes the folder of the weights, and what follows 'encoder' and 'decoder' in the file names."""
        self.folder, self.name = folder, name
        self.pieces = WordPieces(read_text(folder / "pieces.txt").split("\n"))

    @cached_property
    def _encoder(self) -> onnxruntime.InferenceSession:
        return _session(self.folder / f"encoder{self.name}.onnx")

    @cached_property
    def _decoder(self) -> onnxruntime.InferenceSession:
        session = _session(self.folder / f"decoder{self.name}.onnx")
        known = session.get_outputs()[0].shape[1]
        if known > len(TOKENS):
            raise PartError(
                f"the weights in {self.folder} know {known} words of plans, and this version has "
                f"{len(TOKENS)}; they are from a newer version"
            )
        return session

    def knows(self, tokens: Sequence[str]) -> bool:
        """Returns whether the network can write all these tokens; older weights lack the newest ones."""
        known = self._decoder.get_outputs()[0].shape[1]
        return all(NUMBER_OF[token] < known for token in tokens)

    @cached_property
    def has_scenes(self) -> bool:
        """Whether the network can write scenes."""
        return self.knows([SCENE])

    def encode(self, text: SlottedText) -> Array:
        """Returns the keys and values of a description, to which the decoder attends.

        Their shape is (layers, 2, 1, heads, pieces, head size)."""
        found = [self._encoder.run(None, {"pieces": np.array([chunk])})[0] for chunk in self.chunks(text)]
        return np.concatenate(found, axis=4)

    def chunks(self, text: SlottedText) -> list[list[int]]:
        """Returns the numbers of the pieces of a text, chunk by chunk; of the first chunk only, if the
        network was not trained with long texts, as none was that cannot write scenes."""
        chunks = self.pieces.encode(word.text for word in text.words)
        return chunks if self.has_scenes else chunks[:1]

    def chances_of(
        self, texts: Sequence[SlottedText], tokens: Sequence[str], allowed: SlottedText
    ) -> tuple[Array, Array]:
        """Returns how likely one plan is for several variants of a text, each of one chunk.

        The words and numbers of ``allowed`` determine which tokens are allowed.

        Returns:
            Two arrays of shape (texts, tokens + 1), for each token of the plan and its end: the
            log-probability, and its lead over the likeliest other token (negative if the other is likelier).
        """
        rows = [self.chunks(text)[0] for text in texts]
        pieces = np.zeros((len(rows), max(map(len, rows))), dtype=np.int64)
        for row, numbers in enumerate(rows):
            pieces[row, : len(numbers)] = numbers
        across = self._encoder.run(None, {"pieces": pieces})[0]
        seen = np.where(pieces == 0, np.float32(-1e4), np.float32(0))[:, None, None, :]
        own = np.repeat(_nothing(across[:, :, :1]), len(rows), axis=2)
        writer = WrittenPlan.of(allowed, self.has_scenes).writer
        last = START
        logs, leads = list[Array](), list[Array]()
        for place, word in enumerate((*tokens, END)):
            token = np.full((len(rows), 1), last)
            scores, own = self._scored(token, place, own, across, seen)
            last = NUMBER_OF[word]
            may = writer.allowed()
            chances = np.stack([_log_chances(row, may) for row in scores])
            logs.append(chances[:, last])
            others = chances.copy()
            others[:, last] = -np.inf
            leads.append(chances[:, last] - np.maximum(others.max(axis=1), LEAST))
            writer.push(word)
        return np.stack(logs, axis=1), np.stack(leads, axis=1)

    def write(self, across: Array, text: SlottedText, refuse_from: float) -> tuple[WrittenPlan, ...]:
        """Returns the likeliest plans for a description, best first, from a beam search; for ``refuse_from``
        see ``scored_plans``."""
        drafts, done = [WrittenPlan.of(text, self.has_scenes)], list[WrittenPlan]()
        own = _nothing(across)
        for place in range(MOST_TOKENS):
            scores, own = self._step(drafts, place, own, across)
            logs = np.stack(
                [_log_chances(row, d.writer.allowed()) for row, d in zip(scores, drafts, strict=True)]
            )
            if place == 0 and np.exp(logs[0, REFUSED]).sum() < refuse_from:
                logs[0] = _without_refusals(logs[0])
            total = logs + np.array([[sum(draft.log_chances)] for draft in drafts], dtype=np.float32)
            likeliest = np.argsort(total, axis=None)[::-1][: 2 * WIDTH]
            longer, rows = list[WrittenPlan](), list[int]()
            for row, token in zip(*np.unravel_index(likeliest, total.shape), strict=True):
                if total[row, token] > UNKNOWN / 2 and len(longer) < WIDTH:
                    draft = drafts[row].longer(int(token), float(logs[row, token]))
                    if draft.is_done:
                        done.append(draft)
                    else:
                        longer.append(draft)
                        rows.append(int(row))
            if not longer or (
                len(done) >= WIDTH and max(d.score for d in done) >= max(d.score for d in longer)
            ):
                break
            drafts, own = longer, own[:, :, rows]
        return tuple(sorted(done or drafts, key=lambda draft: -draft.score))

    def refusal(self, text: SlottedText) -> float:
        """Returns the probability that the network writes a refusal as the first token."""
        across, draft = self.encode(text), WrittenPlan.of(text, self.has_scenes)
        scores, _ = self._step([draft], 0, _nothing(across), across)
        return float(np.exp(_log_chances(scores[0], draft.writer.allowed())[REFUSED]).sum())

    def drawn(
        self, across: Array, text: SlottedText, rng: np.random.Generator, temperature: float
    ) -> WrittenPlan:
        """Returns a plan sampled token by token, but never a refusal.

        A higher temperature gives more varied plans."""
        draft, own = WrittenPlan.of(text, self.has_scenes), _nothing(across)
        for place in range(MOST_TOKENS):
            scores, own = self._step([draft], place, own, across)
            logs = _log_chances(scores[0], draft.writer.allowed())
            logs = _without_refusals(logs) if place == 0 else logs
            chances = np.exp((logs - logs.max()) / temperature)
            token = int(rng.choice(len(logs), p=chances / chances.sum()))
            draft = draft.longer(token, float(logs[token]))
            if draft.is_done:
                break
        return draft

    def _step(
        self, drafts: Sequence[WrittenPlan], place: int, own: Array, across: Array
    ) -> tuple[Array, Array]:
        token = np.array([[NUMBER_OF[draft.tokens[-1]] if draft.tokens else START] for draft in drafts])
        seen = np.zeros((len(drafts), 1, 1, across.shape[4]), dtype=np.float32)
        return self._scored(token, place, own, np.repeat(across, len(drafts), axis=2), seen)

    def _scored(
        self, token: Numbers, place: int, own: Array, across: Array, seen: Array
    ) -> tuple[Array, Array]:
        """Returns the scores of the next tokens, and ``own`` extended by the keys and values of ``token``.

        Tokens that are newer than the weights are never written."""
        feed = {"token": token, "place": np.array([place]), "own": own, "across": across, "seen": seen}
        scores, kept = self._decoder.run(None, feed)
        newer = ((0, 0), (0, len(TOKENS) - scores.shape[1]))
        return np.pad(scores, newer, constant_values=UNKNOWN), kept


def _nothing(across: Array) -> Array:
    """Returns the keys and values of a plan without tokens; ``across`` gives the sizes of the network."""
    layers, _, _, heads, _, size = across.shape
    return np.zeros((layers, 2, 1, heads, 0, size), dtype=np.float32)


def _without_refusals(logs: Array) -> Array:
    """Returns the log-probabilities of the first token, normalised again after refusals are excluded."""
    out = logs.copy()
    out[REFUSED] = -np.inf
    top: Array = out - np.log(np.exp(out[np.isfinite(out)]).sum())
    return top


def _session(path: Path) -> onnxruntime.InferenceSession:
    options = onnxruntime.SessionOptions()
    options.intra_op_num_threads = 1
    options.inter_op_num_threads = 1
    options.log_severity_level = 3
    try:
        return onnxruntime.InferenceSession(str(path), options, providers=["CPUExecutionProvider"])
    except Exception as error:  # onnxruntime has 15 kinds, with no other base in common
        raise PartError(
            f"'{path}' cannot be loaded: it is damaged, or a file beside it is missing; copy the "
            "whole folder again, or let a training write it"
        ) from error


def _log_chances(scores: Array, allowed: Sequence[int]) -> Array:
    out = np.full(len(scores), -np.inf, dtype=np.float32)
    some = scores[list(allowed)]
    out[list(allowed)] = some - (some.max() + np.log(np.exp(some - some.max()).sum()))
    return out
