"""Providers, which are plug-ins: one for servers with OpenAI's protocol, and one for replayed exchanges."""
