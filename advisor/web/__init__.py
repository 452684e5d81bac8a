"""The screens in a browser: a web server, one process per page, and the campaigns that pages show."""
