"""Imports onnxruntime, the only module that does, with its telemetry switched off.

Since version 1.31 onnxruntime looks up a host of its maker when it is imported, and stores a device id in
the user's cache. The variable is read once, at the import; the function that switches telemetry off comes
too late."""

import os

os.environ["ORT_DISABLE_TELEMETRY"] = "1"

import onnxruntime

__all__ = ["onnxruntime"]
