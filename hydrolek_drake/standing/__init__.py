"""Where to stand: places of base and boom from which both arms can grasp and cut a pipe (thesis 5.2.1)."""
