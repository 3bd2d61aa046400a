"""From the operator's clicks to moving arms: task, link to the controllers, web console."""
