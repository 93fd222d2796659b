"""Documents as values, and their form as Markdown and as terminal text; report/html.py makes HTML of them."""
