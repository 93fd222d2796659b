"""Files held against their schemas, from the command line."""
