"""Linear algebra in one thread after the import of this module, before a plugin of pytest loads numpy."""

from advisor.process.tasks.threads import pin_linear_algebra

pin_linear_algebra()
