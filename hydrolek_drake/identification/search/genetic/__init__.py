"""The genetic algorithms of thesis section 4.4, on pymoo's engine."""
