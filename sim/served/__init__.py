"""The twin behind real wires: a Modbus port, a serial line, a folder, and a control beside them."""
