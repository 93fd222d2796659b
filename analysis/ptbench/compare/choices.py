"""Words of the command line of `compare` that its code needs as well."""

# Words that `compare --fail-on` accepts.
FAIL_ON = ("slower", "different", "unmatched", "failed")
