"""Driver plug-ins: each file defines one class with ``start(road, world, seed)`` and ``steer(view)``."""
