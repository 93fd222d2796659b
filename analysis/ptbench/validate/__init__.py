"""The command `validate`, which checks files against their schemas."""
