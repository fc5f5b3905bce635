"""Drivers of arm, lamps and camera, each talking through a transport."""
