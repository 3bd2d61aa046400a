"""Models of joints for the design of control laws."""
