"""A machine of your own behind `hydrolek serve --adapter machine_adapter.py:Machine`; here a memory stands for its I/O.

Replace `write` and `read` by your driver's calls. The controllers are yours: this one is proportional.
"""

import numpy as np

GAIN_V_PER_DEG = 0.5
LIMIT_V = 5.0
SCALING_DEG_PER_V = 8.0  # of the potentiometers


class Machine:
    """Everything that `hydrolek serve` asks of a machine; all calls come from one thread."""

    period = 0.05  # s between two calls of `advance`

    def __init__(self):
        self.channels = np.zeros(14)  # V
        self.angles_deg = np.array([-20.0, 20, -20, 20, -20, 0, 40, 20, 20, -20, -20, -20, 0, 40])

    def advance(self, order):
        """Carry out what the client wants for one sample."""
        if not order.valves_open:
            self.write(np.zeros(14))
        elif order.deflection is not None:  # joysticks, -100 to 100 %
            self.write(LIMIT_V * order.deflection / 100.0)
        else:
            error_deg = np.degrees(order.desired) - self.angles_deg
            self.write(np.clip(GAIN_V_PER_DEG * error_deg, -LIMIT_V, LIMIT_V))

    def measured(self):
        """Joints right_j1 ... left_j7 in rad."""
        self.angles_deg = self.read()
        return np.radians(self.angles_deg)

    def signals(self):
        """None, or hydrolek_drake.teleop.link.signals.Signals: voltages and pressures for the console's charts."""
        return None

    def close(self):
        """Called once at the end, whatever has happened."""
        self.write(np.zeros(14))

    def write(self, voltages):
        """In place of your analogue outputs."""
        self.channels = voltages

    def read(self):
        """In place of your analogue inputs: joints that turn with 8 deg/s for each volt."""
        return self.angles_deg + SCALING_DEG_PER_V * self.period * self.channels
