"""Makes training data for readers, trains readers, and scores how well they read. Main function:
``readings``.

Hand-written pairs of a description and its plan are in ``data/descriptions``; ``generator.pairs`` generates
any number of further pairs. ``labels`` reads and checks pairs, ``near_duplicates`` finds descriptions that
are nearly the same, and ``evaluate`` compares the readings of a reader with the labels.
"""
