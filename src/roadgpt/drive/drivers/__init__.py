"""Driver plug-ins: one file each, every one a class with ``start(road, world, seed)`` and ``steer(view)``."""
