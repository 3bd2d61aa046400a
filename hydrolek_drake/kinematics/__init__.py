"""Where the arms' links, tools and cylinders are, as pure functions of the joint angles."""
