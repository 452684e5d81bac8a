"""One module for each command; the command line imports only the module that it calls."""
