"""The service of the SDC testing competition: selects or prioritises given roads by predicted risk.

It needs the extra ``roadgpt[sdc]``: import ``roadgpt.sbft.sdc.service``.
"""
