"""A suite on several models of GPU: ratios, rankings that change, and how much of a ratio a data sheet explains."""
