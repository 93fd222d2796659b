"""A suite on several GPU models: time ratios, changed rankings, and how much of a ratio data sheets explain."""
