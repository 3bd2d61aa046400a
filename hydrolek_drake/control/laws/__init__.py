"""Control laws, what they are wrapped in, and the maps of joints that they need."""
