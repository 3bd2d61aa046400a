"""From the camera's picture to targets for the arms: thesis sections 5.2.2 to 5.2.5, and surfaces from depth."""
