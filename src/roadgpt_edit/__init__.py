"""Changes roads as requests in plain words ask.

editing         ``edit`` changes a Design as a change request asks, and leaves the rest as it was
command         ``roadgpt edit``: reads the road, and writes the changed one into a new folder
"""
