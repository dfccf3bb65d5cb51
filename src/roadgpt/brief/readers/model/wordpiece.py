"""BERT's word pieces: splits words by the greedy longest match in a vocabulary of lower-case pieces."""

from collections.abc import Iterable, Sequence
from functools import lru_cache

UNKNOWN = "[UNK]"
LONGEST = 40  # letters; anything longer is not split
WINDOW = 126
"""The largest number of pieces of a text that are read, without the special pieces at its two ends."""


class WordPieces:
    """Splits words into the pieces of a vocabulary; the number of a piece is its index in the vocabulary."""

    def __init__(self, pieces: Sequence[str]) -> None:
        self.number = {piece: index for index, piece in enumerate(pieces)}
        self._split = lru_cache(maxsize=4096)(self._pieces)

    def encode(self, words: Iterable[str]) -> tuple[list[int], list[int]]:
        """Returns the numbers of all pieces, and for each piece the index of its word (-1 for the special end
        pieces).
        """
        numbers, of_word = [self.number["[CLS]"]], [-1]
        for index, word in enumerate(words):
            for piece in self._split(word):
                if len(numbers) <= WINDOW:
                    numbers.append(piece)
                    of_word.append(index)
        return [*numbers, self.number["[SEP]"]], [*of_word, -1]

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
        return tuple(out) if out and start == len(word) else (self.number[UNKNOWN],)
