"""Test generators, one plug-in per file, which propose the tests of a cell; see
``campaign.model.Generator``."""
