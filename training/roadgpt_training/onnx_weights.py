"""Reads the weights of an exported reader, so that a new training run can start from the installed reader."""

from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt

from roadgpt.errors import UsageError

Floats = npt.NDArray[np.float32]
OURS = "reader."
"""Prefix of the names of the reader's own weights in the ONNX graphs."""


def exported_weights(folder: Path, ending: str = "") -> dict[str, Floats]:
    """Returns the weights by their parameter names in ``network.ReaderNetwork``. Weights that were
    exported in int8 stay rounded. ``ending`` is what precedes ".onnx" in the names of the files.

    Raises:
        UsageError: the folder has no exported reader.
    """
    from onnx import load

    found: dict[str, Floats] = {}
    for name in ("encoder", "decoder"):
        path = folder / f"{name}{ending}.onnx"
        if not path.is_file():
            raise UsageError(f"there is no {path.name} in {folder}; give the folder of an exported reader")
        found |= _weights_of(load(str(path)).graph)
    return found


def _weights_of(graph: Any) -> dict[str, Floats]:
    from onnx.numpy_helper import to_array

    arrays = {tensor.name: np.asarray(to_array(tensor)) for tensor in graph.initializer}
    found = {
        name.removeprefix(OURS): array.astype(np.float32)
        for name, array in arrays.items()
        if name.startswith(OURS) and array.dtype == np.float32 and not name.endswith("_scale")
    }
    for name in arrays:
        if name.startswith(OURS) and name.endswith("_quantized"):  # an embedding
            own = name.removesuffix("_quantized")
            found[own.removeprefix(OURS)] = _rounded(arrays, own)
    followers = {source: node for node in graph.node for source in node.input}
    for node in graph.node:
        if node.op_type == "MatMulInteger":
            bias = _bias_behind(node, followers)
            if bias.endswith(".bias") and bias != f"{OURS}bias":  # the scores use the tokens' embedding
                weight = _rounded(arrays, node.input[1].removesuffix("_quantized"))
                found[bias.removeprefix(OURS).removesuffix("bias") + "weight"] = weight.T.copy()
    return found


def _rounded(arrays: dict[str, npt.NDArray[Any]], name: str) -> Floats:
    """Returns the values of an int8 weight, with one scale for all or one per column."""
    whole = arrays[f"{name}_quantized"].astype(np.float32)
    zero = arrays[f"{name}_zero_point"].astype(np.float32)
    out: Floats = (whole - zero) * arrays[f"{name}_scale"].astype(np.float32)
    return out


def _bias_behind(node: Any, followers: dict[str, Any]) -> str:
    """Returns the name of the first bias that is added to a product."""
    while node.op_type != "Add":
        node = followers[node.output[0]]
    return next((str(name) for name in node.input if name.startswith(OURS)), "")
