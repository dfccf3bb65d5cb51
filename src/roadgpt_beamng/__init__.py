"""The simulator ``beamng``; it needs beamngpy, which is imported when the first road is driven."""
