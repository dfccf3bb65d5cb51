"""The door for agents: ``roadgpt mcp``, a server with tools, and ``roadgpt skill``, a page to read."""
