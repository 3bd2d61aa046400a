"""From descriptions of the machine to Drake plants and diagrams."""
