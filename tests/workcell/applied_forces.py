"""What forces on the bodies of a plant come to together."""

import numpy as np


def total_force(plant, forces, state):
    """Sum of forces [N], and of their moments about the world's origin [N m], with the plant in that state."""
    own = plant.CreateDefaultContext()
    plant.SetPositionsAndVelocities(own, state)
    force, moment = np.zeros(3), np.zeros(3)
    for each in forces:
        place = plant.EvalBodyPoseInWorld(own, plant.get_body(each.body_index)) @ each.p_BoBq_B
        force += each.F_Bq_W.translational()
        moment += each.F_Bq_W.rotational() + np.cross(place, each.F_Bq_W.translational())
    return force, moment
