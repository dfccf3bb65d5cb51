"""A grown network first writes what the smaller one wrote."""

import pytest

torch = pytest.importorskip("torch", reason="comes with the extra 'learn'")

from roadgpt.errors import UsageError  # noqa: E402
from roadgpt_training.growing import deepened, grown  # noqa: E402
from roadgpt_training.network import DECODER, ENCODER, NetworkSizes, ReaderNetwork, layers_of  # noqa: E402

SMALL = NetworkSizes(pieces=40, tokens=9, width=24, heads=3, inner=32, layers=1, decoder_layers=2,
                     decoder_inner=32, decoder_heads=3)  # fmt: skip


def test_more_layers_and_tokens_change_no_score_of_an_old_token() -> None:
    torch.manual_seed(3)
    small = ReaderNetwork(SMALL).eval()
    weights = small.state_dict()
    large = ReaderNetwork(NetworkSizes(**{**_fields(SMALL), "tokens": 12, "decoder_layers": 6})).eval()
    large.load_state_dict(grown(weights, 12, 6))
    pieces, tokens = torch.randint(1, 40, (3, 1, 7)), torch.randint(1, 9, (3, 5))
    with torch.no_grad():
        old, new = small(pieces, tokens), large(pieces, tokens)
    assert torch.allclose(old, new[..., :9], atol=1e-5)
    assert layers_of(large.state_dict(), DECODER) == 6
    assert any(not torch.equal(new[..., 9], new[..., other]) for other in (10, 11))


def test_a_network_does_not_shrink() -> None:
    weights = ReaderNetwork(SMALL).state_dict()
    for tokens, layers in ((8, 2), (9, 1), (9, 3)):
        with pytest.raises(UsageError, match="cannot grow"):
            grown(weights, tokens, layers)


def test_a_deeper_encoder_hardly_changes_the_scores_at_first() -> None:
    torch.manual_seed(4)
    sizes = NetworkSizes(**{**_fields(SMALL), "layers": 2})
    small = ReaderNetwork(sizes).eval()
    with torch.no_grad():  # norms as a trained network has them, with different gains
        for layer in small.layers:
            layer.last_norm.weight.uniform_(0.8, 1.2)
            layer.last_norm.bias.uniform_(-0.1, 0.1)
    weights = small.state_dict()
    large = ReaderNetwork(NetworkSizes(**{**_fields(SMALL), "layers": 6})).eval()
    large.load_state_dict(deepened(weights, 6))
    pieces, tokens = torch.randint(1, 40, (8, 1, 7)), torch.randint(1, 9, (8, 5))
    with torch.no_grad():
        old, new = small(pieces, tokens), large(pieces, tokens)
    assert layers_of(large.state_dict(), ENCODER) == 6
    assert torch.corrcoef(torch.stack([old.ravel(), new.ravel()]))[0, 1] > 0.99
    with pytest.raises(UsageError, match="cannot grow"):
        deepened(weights, 3)


def _fields(sizes: NetworkSizes) -> dict[str, int]:
    return {name: getattr(sizes, name) for name in sizes.__slots__}
