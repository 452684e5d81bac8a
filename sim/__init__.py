"""The bundled aircraft: flight dynamics, instruments and a MAVLink voice of its own."""
