"""The rules: one file per rule, with one function ``inspect`` and a source for its limit."""
