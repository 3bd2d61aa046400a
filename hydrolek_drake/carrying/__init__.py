"""Both arms carry one pipe: plan, and the full plant with the force between the arms."""
