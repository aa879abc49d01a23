"""A living cell in the browser: sessions, server, and what its page is told."""
