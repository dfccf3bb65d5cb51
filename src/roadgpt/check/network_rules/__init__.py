"""Contains the rules of networks: each module defines one function ``inspect`` and states the source of its
limit.
"""
