"""Providers: one file for each kind of server, and one for replayed exchanges."""
