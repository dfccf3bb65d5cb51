"""The shelf of rules: one file per rule, one function ``inspect`` in it, one source for its limit."""
