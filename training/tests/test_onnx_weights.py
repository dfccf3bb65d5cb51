"""A training can go on from what is installed: its graphs' whole numbers are weights again."""

from pathlib import Path

import numpy as np
import pytest
from scipy.special import erf

from roadgpt.brief.readers.model import WEIGHTS
from roadgpt.errors import UsageError
from roadgpt_training.onnx_weights import exported_weights
from roadgpt_training.pretrained import begin

LAYERS = 3  # of the first network's decoder
ENCODER_LAYERS = 12
onnxruntime = pytest.importorskip("onnxruntime")
pytest.importorskip("onnx", reason="comes with the extra 'learn'")


@pytest.fixture(scope="module")
def weights() -> dict[str, np.ndarray]:
    return exported_weights(WEIGHTS)


def _layer_norm(x: np.ndarray, weights: dict[str, np.ndarray], name: str, eps: float) -> np.ndarray:
    x = (x - x.mean(-1, keepdims=True)) / np.sqrt(x.var(-1, keepdims=True) + eps)
    return x * weights[f"{name}.weight"] + weights[f"{name}.bias"]


def _linear(x: np.ndarray, weights: dict[str, np.ndarray], name: str) -> np.ndarray:
    return x @ weights[f"{name}.weight"].T + weights[f"{name}.bias"]


def _heads(x: np.ndarray, number: int) -> np.ndarray:
    return x.reshape(len(x), number, -1).transpose(1, 0, 2)


def _keys_and_values(numbers: np.ndarray, weights: dict[str, np.ndarray]) -> np.ndarray:
    """BERT as its paper has it, and what our decoder makes of its last layer."""
    x = weights["pieces.weight"][numbers] + weights["places.weight"][: len(numbers)] + weights["kind"]
    x = _layer_norm(x, weights, "norm", 1e-12)
    for index in range(ENCODER_LAYERS):
        own = f"layers.{index}"
        query, key, value = (
            _heads(_linear(x, weights, f"{own}.attention.{part}"), 12) for part in ("query", "key", "value")
        )
        scores = query @ key.transpose(0, 2, 1) / np.sqrt(32)
        shares = np.exp(scores - scores.max(-1, keepdims=True))
        mixed = (shares / shares.sum(-1, keepdims=True) @ value).transpose(1, 0, 2).reshape(len(x), -1)
        x = _layer_norm(x + _linear(mixed, weights, f"{own}.attention.out"), weights, f"{own}.norm", 1e-12)
        wide = _linear(x, weights, f"{own}.wide")
        wide = wide * (1 + erf(wide / np.sqrt(2))) / 2
        x = _layer_norm(x + _linear(wide, weights, f"{own}.narrow"), weights, f"{own}.last_norm", 1e-12)
    made = [
        _heads(_linear(x, weights, f"decoder.{layer}.across.{part}"), 6)
        for layer in range(LAYERS)
        for part in ("key", "value")
    ]
    return np.stack(made).ravel()


def test_bert_written_down_in_numpy_gives_what_the_graph_gives(weights: dict[str, np.ndarray]) -> None:
    numbers = np.array([26, 400, 1200, 3000, 77, 27])
    session = onnxruntime.InferenceSession(str(WEIGHTS / "encoder.onnx"), providers=["CPUExecutionProvider"])
    (theirs,) = session.run(None, {"pieces": numbers[None]})
    said = np.asarray(theirs).ravel()
    # the graph rounds what goes through it to 8 bits as well, so the two are not the same numbers
    assert np.corrcoef(_keys_and_values(numbers, weights), said)[0, 1] > 0.98
    names = [f"layers.{index}.attention.out.weight" for index in range(ENCODER_LAYERS)]
    turned = {**weights, **{name: weights[name].T for name in names}}
    assert np.corrcoef(_keys_and_values(numbers, turned), said)[0, 1] < 0.95


def test_every_parameter_of_the_network_is_there(weights: dict[str, np.ndarray]) -> None:
    torch = pytest.importorskip("torch", reason="comes with the extra 'learn'")
    from roadgpt.brief.readers.model.vocabulary import OF_ROADS
    from roadgpt_training.network import DECODER, ENCODER, layers_of, network_of

    tensors = {name: torch.from_numpy(array) for name, array in weights.items()}
    network_of(tensors, len(weights["pieces.weight"]), len(OF_ROADS))
    assert (layers_of(tensors, ENCODER), layers_of(tensors, DECODER)) == (ENCODER_LAYERS, LAYERS)


def test_a_folder_without_a_reader_is_told_so(tmp_path: Path) -> None:
    with pytest.raises(UsageError, match=r"there is no encoder\.onnx"):
        exported_weights(tmp_path)
    with pytest.raises(UsageError, match=r"there is no pieces\.txt"):
        begin(tmp_path / "out", None, tmp_path)
    with pytest.raises(UsageError, match="--installed"):
        begin(tmp_path / "out", None)
