"""The table of the language: its rows, and what asks them."""
