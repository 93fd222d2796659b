"""`python3 -m ptbench report`: one page of one or more result files, as HTML that needs nothing else, and as Markdown.

sources.py says which files; chapter.py makes each file's chapter, figures included, in a process of its own;
overview.py puts the chapters' facts together; html.py and markdown.py write the same blocks.
"""
