"""Words of the command line of `compare` that its code asks for, too."""

# What --fail-on may name.
FAIL_ON = ("slower", "different", "unmatched", "failed")
