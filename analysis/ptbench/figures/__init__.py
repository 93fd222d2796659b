"""One module a figure: what it shows of a result, how that is drawn, and its name, by which `registry` finds it."""
