"""The rig's twin: drives, lamps, camera and materials, answering the rig's own protocol."""
