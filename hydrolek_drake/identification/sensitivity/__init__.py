"""Which parameters matter, and when (thesis sections 4.3.2 and 4.3.3, appendix B)."""
