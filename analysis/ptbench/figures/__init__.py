"""One module a figure: what it shows of a result, and how that is drawn. `registry` knows them by name."""
