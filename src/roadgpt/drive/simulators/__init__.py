"""Simulator plug-ins."""
