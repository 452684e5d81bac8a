"""``python -m benchmarks.third_generator``."""

from benchmarks.sealed.generator import command

from .files import cases

if __name__ == "__main__":
    command(cases, "benchmarks.third_generator")()
