"""Contains the rules: each module defines one function ``inspect`` and states the source of its limit."""
