"""How the repository's folders become packages; all else stands in pyproject.toml.

In the repository the simulator is ``sim`` and the logs are ``logs``. In a wheel both get names that no other
program takes: ``inflight_sim``, and ``advisor.sample`` with two logs and an aircraft file. An editable
installation leaves the repository's names as they are.
"""

import sys

from setuptools import find_namespace_packages, setup

SAMPLE = ("arduplane-calm.tlog", "arduplane-calm.yaml", "arduplane-default-rates.tlog")
"""The files of ``logs`` that ``advisor sample`` hands out."""

# Folders of data alone (styles, scenarios) count, too; caches do not.
simulator = find_namespace_packages(include=["sim", "sim.*"], exclude=["*.__pycache__"])
advisor = find_namespace_packages(include=["advisor", "advisor.*"], exclude=["*.__pycache__"])

if "editable_wheel" in sys.argv:
    setup(packages=[*advisor, *simulator])
else:
    setup(
        packages=[*advisor, *("inflight_" + name for name in simulator), "advisor.sample"],
        package_dir={"inflight_sim": "sim", "advisor.sample": "logs"},
        package_data={"advisor.sample": list(SAMPLE)},
        exclude_package_data={"advisor.sample": ["arduplane-turbulent.*", "bundled-demo.*", "*.md"]},
    )
