"""Asks RoadGPT for every computation that needs more than the standard library.

If the environment variable ROADGPT_PYTHON names an interpreter, RoadGPT is started in that interpreter; else
RoadGPT must be installed in this interpreter, and is called directly. A forked process starts its own RoadGPT
process.
"""

from __future__ import annotations

import os
from importlib import import_module
from typing import Any, List

import roadgpt_client

_ASKED: List[roadgpt_client.RoadGPT] = []


def ask(op: str, **values: Any) -> Any:
    """Returns RoadGPT's answer to a request for the operation ``op``."""
    if not os.environ.get(roadgpt_client.PYTHON):
        try:
            answers = import_module("roadgpt_sbft.answers")
        except ImportError:
            pass
        else:
            answer = answers.answer({"op": op, **values})
            if "error" in answer:
                raise roadgpt_client.ClientError(answer["error"])
            return answer["answer"]
    if not _ASKED or not _ASKED[0].is_ours:
        _ASKED[:] = [roadgpt_client.RoadGPT()]
    return _ASKED[0].ask(op, **values)
