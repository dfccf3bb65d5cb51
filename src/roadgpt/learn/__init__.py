"""Makes training data for readers, trains them, and scores how well they read. Verb: ``readings``.

Hand-written pairs of a description and its plan are in ``data/descriptions``; ``generator.pairs`` draws
any number of others. ``labels`` reads and checks pairs, ``near_duplicates`` finds descriptions that are
copies of each other, and ``evaluate`` compares what a reader makes of them with the labels.
"""
