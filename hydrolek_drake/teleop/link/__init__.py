"""Console and controllers on two machines: the text protocol between them, its server and its client."""
