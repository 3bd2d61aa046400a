"""How probable structures are, by data that none of them was fitted to, the verdict, and what would decide."""
