"""`python3 -m ptbench report`: a report on result files, as self-contained HTML and as Markdown.

sources.py says which files; chapter.py makes each file's chapter, figures included, in a process of its own. The page
opens with what each file says, in words (findings.py) and in one figure (forest.py); overview.py puts the chapters'
facts together; html.py and markdown.py write the same blocks.
"""
