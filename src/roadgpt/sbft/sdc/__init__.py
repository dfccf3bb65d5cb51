"""The SDC testing competition's service: selects or prioritises given roads by predicted risk.

Needs the extra ``roadgpt[sdc]``: import ``roadgpt.sbft.sdc.service``.
"""
