"""The operator's console: a page, a web socket, and who may do what over it."""
