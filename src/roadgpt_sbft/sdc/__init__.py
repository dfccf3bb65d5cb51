"""A service for the SDC testing competition, which selects or prioritises roads by risk: ``service``."""
