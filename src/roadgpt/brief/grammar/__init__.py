"""The stages of the grammar reader, in the order in which they run.

``tokens`` (words, numbers, marks) -> ``lexicon`` (meanings of words and phrases) -> ``quantities`` (numbers
with bounds and units) -> ``context`` (one meaning for each ambiguous word) -> ``chunking`` (groups words that
belong together into phrases, with ``handlers``) -> ``brief_builder`` (converts the phrases to features, with
``driving_order``, ``modifiers``, ``scope`` and ``slopes``) -> ``lowering`` (makes the Brief, with
``reordering``)
"""
