"""The pieces of the grammar reader, in the order in which they work.

tokens -> lexicon (phrases of the vocabularies get their meanings) -> quantities (numbers, bounds, units)
-> context (words with two meanings) -> phrases (what belongs together) -> units (things along the road)
-> slopes -> promises (the Brief)
"""
