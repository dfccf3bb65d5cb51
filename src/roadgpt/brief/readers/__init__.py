"""Readers, which turn a description into a Brief; one plug-in per file."""
