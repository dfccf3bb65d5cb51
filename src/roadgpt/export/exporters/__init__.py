"""The exporters: one format per file, each registered under the entry point ``roadgpt.exporters``."""
