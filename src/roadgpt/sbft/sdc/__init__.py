"""Implements a tool for the SDC testing competition, as a service that selects or prioritises roads by their
predicted risk.

It needs the extra ``roadgpt[sdc]``: import ``roadgpt.sbft.sdc.service``.
"""
