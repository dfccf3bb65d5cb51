"""Providers: one plug-in for servers with OpenAI's protocol, and one for replayed exchanges."""
