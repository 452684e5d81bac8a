"""Write sealed flights of ArduPlane, and their key beside the folder."""

from benchmarks.sealed.generator import command

from .cases import cases

if __name__ == "__main__":
    command(cases, "benchmarks.arduplane_generator")()
