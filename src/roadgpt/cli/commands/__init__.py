"""One command per file, each called ``command``; the table of them stands in ``roadgpt.cli.app``."""
