"""The stages of the grammar reader, in the order in which they run.

``tokens`` -> ``lexicon`` (phrases of the vocabularies get their meanings) -> ``quantities`` (numbers, bounds,
units) -> ``context`` (words with two meanings) -> ``chunking`` (words that belong together become phrases, by
``handlers``) -> ``brief_builder`` (phrases become features in ``driving_order``, with ``modifiers``,
``scope`` and ``slopes``) -> ``lowering`` (the Brief, after ``reordering``)
"""
