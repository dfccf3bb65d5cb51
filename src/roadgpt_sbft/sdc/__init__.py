"""Implements a tool for the SDC testing competition, as a service that selects or prioritises roads by their
predicted risk.

To use it, install the extra ``roadgpt[sdc]`` and import ``roadgpt_sbft.sdc.service``.
"""
