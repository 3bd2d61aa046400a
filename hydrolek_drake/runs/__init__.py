"""Running a scenario, and what a run leaves behind: signals, picture, page, 3-D replay."""
