"""Readers: words in, a Brief out; one part per file, here with the pieces of the grammar."""
