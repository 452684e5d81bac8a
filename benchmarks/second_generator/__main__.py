"""``python -m benchmarks.second_generator``."""

from benchmarks.sealed.generator import command

from .cases import cases

if __name__ == "__main__":
    command(cases, "benchmarks.second_generator")()
