"""The screens in a browser: a web server, one process for each page, and the displayed campaigns."""
