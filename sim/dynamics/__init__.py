"""The physics of one axis: motor, gear, friction, flexible arm, integrated at any step."""
