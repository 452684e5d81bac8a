"""The bundled aircraft: flight dynamics, instruments, and its own MAVLink messages."""
