"""Asks RoadGPT what takes more than the standard library.

Where RoadGPT is installed in this interpreter, it is asked here; else it is started in its own, whose path
stands in ROADGPT_PYTHON. A process that is forked from this one starts one for itself.
"""

from __future__ import annotations

import os
from importlib import import_module
from typing import Any, List

import roadgpt_client

_ASKED: List[roadgpt_client.RoadGPT] = []


def ask(op: str, **values: Any) -> Any:
    """What RoadGPT answers.

    Raises:
        RoadGPTError: RoadGPT says why it has no answer, or cannot be asked.
    """
    if not os.environ.get(roadgpt_client.PYTHON):
        try:
            answers = import_module("roadgpt.sbft.answers")
        except ImportError:
            pass
        else:
            answer = answers.answer({"op": op, **values})
            if "error" in answer:
                raise roadgpt_client.RoadGPTError(answer["error"])
            return answer["answer"]
    if not _ASKED or not _ASKED[0].is_ours:
        _ASKED[:] = [roadgpt_client.RoadGPT()]
    return _ASKED[0].ask(op, **values)
