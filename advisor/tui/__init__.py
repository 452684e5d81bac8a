"""The Textual application. This package imports all other packages, and no package imports this one."""
