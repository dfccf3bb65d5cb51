"""Names of folders and seeds of roads."""

import re
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from roadgpt.errors import UsageError
from roadgpt.run.folder import new_folder, slug
from roadgpt.run.model import seed_of


@given(st.text(max_size=300))
def test_a_slug_is_a_safe_name_whatever_the_words(words: str) -> None:
    assert re.fullmatch(r"[a-z0-9](?:[a-z0-9-]{0,38}[a-z0-9])?", slug(words))


@pytest.mark.parametrize(
    ("words", "name"),
    [
        ("An uphill road, with 3 turns!", "an-uphill-road-with-3-turns"),
        ("../../etc/passwd", "etc-passwd"),
        ("C:\\Windows\x00", "c-windows"),
        ("Straße über Höhen", "strasse-uber-hohen"),
        ("道路", "road"),
        ("", "road"),
    ],
)
def test_slugs(words: str, name: str) -> None:
    assert slug(words) == name


def test_a_folder_is_never_taken_twice(tmp_path: Path) -> None:
    home = tmp_path / "runs"
    names = [new_folder("A road", 7, home).name for _ in range(3)]
    assert names == ["a-road-7", "a-road-7-2", "a-road-7-3"]
    assert all((home / name).is_dir() for name in names)


def test_where_no_folder_can_be_made_it_says_so(tmp_path: Path) -> None:
    (tmp_path / "file").write_text("")
    with pytest.raises(UsageError, match="--out FOLDER"):
        new_folder("a road", 1, tmp_path / "file")


def test_neighbouring_campaigns_share_no_seed() -> None:
    seeds = [seed_of(seed, index) for seed in range(50) for index in range(1, 101)]
    assert len(set(seeds)) == len(seeds)
    assert all(0 <= seed < 2**53 for seed in seeds)


def test_a_seed_is_the_upper_53_bits_that_numpy_promises() -> None:
    low, high = (int(word) for word in np.random.SeedSequence([7, 3]).generate_state(2))
    assert seed_of(7, 3) == (high * 2**32 + low) // 2**11


def test_a_seed_survives_readers_that_know_no_integers() -> None:
    seed = seed_of(2**63 - 1, 1_000_000)
    assert int(float(seed)) == seed
