"""The web server of the bridge: the page, its WebSocket, and what is refused."""
