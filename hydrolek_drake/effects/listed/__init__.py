"""The effects that a diagnosis can name: one file each."""
