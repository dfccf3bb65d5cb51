"""Moves some of the others on the road: recorded tracks. Each mover is a plug-in."""
