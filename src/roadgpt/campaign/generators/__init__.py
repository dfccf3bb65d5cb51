"""Generators: what thinks out the tests of a cell, one per file; see ``campaign.model.Generator``."""
