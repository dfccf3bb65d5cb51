"""One command per file, each called ``command``; ``roadgpt.cli.command_table`` lists them."""
