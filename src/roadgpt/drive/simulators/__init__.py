"""The shelf of simulators."""
