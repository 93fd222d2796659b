"""Pages of findings: prose from templates, with numbers looked up in committed results and verdicts checked.

`docs/templates/*.md` are Jinja templates with a head of JSON that names the result files; `python3 -m ptbench findings`
renders them to `docs/findings/*.md` and `README.md`. A page whose words contradict its data is not written.
"""
