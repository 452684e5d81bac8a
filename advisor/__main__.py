"""``python -m advisor`` is the ``advisor`` command."""

from advisor.start import main

main()
