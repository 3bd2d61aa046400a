"""What stands in the lines between pump, valve and actuator: hoses and accumulators."""
