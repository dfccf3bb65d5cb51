"""The movers that come with RoadGPT: plug-ins, each moves a part of those on the road."""
