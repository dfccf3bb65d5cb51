"""Contains the rules of networks: each module defines one function ``inspect`` and states its source."""
