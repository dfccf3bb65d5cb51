"""Descriptions and what they ask for: makes pairs, and the score of a reader. Verb: ``readings``.

Hand-written pairs lie in ``data/descriptions``; ``generator.pairs`` draws any number of others. ``labels``
reads and checks them, ``originality`` finds descriptions that were not written one by one, and ``evaluate``
holds a reader against them.
"""
