"""Laws for physics in no list: where they enter, what they are made of, and how they are told."""
