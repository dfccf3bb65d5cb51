"""Two providers (plug-ins): one for servers with OpenAI's protocol, and one for recorded exchanges."""
