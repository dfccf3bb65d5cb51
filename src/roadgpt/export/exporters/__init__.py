"""Contains the exporters, one module per format. Their entry point group is ``roadgpt.exporters``."""
