"""Documents as values, and as Markdown and as text for a terminal; HTML is report/html.py."""
