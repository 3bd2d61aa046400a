"""What a search makes small: norms of the output error, over all of a recording or part by part."""
