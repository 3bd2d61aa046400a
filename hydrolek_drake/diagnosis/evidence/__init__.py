"""How probable structures are, by data that none of them was fitted to, and the verdict."""
