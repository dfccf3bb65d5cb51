"""The commands, in one module for each heading of ``roadgpt --help``; ``roadgpt.cli.app`` lists them."""
