"""Test generators that search, or that searches are compared with: ``quality_diversity``, ``genetic`` and
``random``. They make roads by varying tested roads, and learn from the results of their tests.
"""
