"""One format per file; each is registered under the entry point ``roadgpt.exporters``."""
