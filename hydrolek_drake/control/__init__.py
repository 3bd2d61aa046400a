"""Controllers of chapters 6 and 7 and better ones: design, difference equations, Drake systems, comparison."""
