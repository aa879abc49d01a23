"""A living cell in the browser: sessions, the server, and the data that it sends to the page."""
