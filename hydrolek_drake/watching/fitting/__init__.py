"""What one recording says of the machine and of every effect: fits, sizes held, and the likelihood of a size."""
