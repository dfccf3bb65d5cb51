"""The service of the SDC testing competition: selects or prioritises roads by their predicted risk.

It needs the extra ``roadgpt[sdc]``: import ``roadgpt.sbft.sdc.service``.
"""
