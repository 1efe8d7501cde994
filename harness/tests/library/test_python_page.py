"""The examples of docs/python.md print what the page shows. Usage: test_python_page.py PAGE"""

import contextlib
import io
import re
import sys

try:
    import numpy  # noqa: F401
except ImportError:
    print("skipped: python3-numpy is not installed")
    sys.exit(77)

with open(sys.argv[1]) as file:
    page = file.read()
examples = re.findall(r"```python\n(.*?)```\n\n```\n(.*?)```\n", page, re.S)
if len(examples) != page.count("```python\n"):
    sys.exit(f"{sys.argv[1]}: an example is not followed by what it prints")
for example, shown in examples:
    printed = io.StringIO()
    with contextlib.redirect_stdout(printed):
        exec(example, {"__name__": "example"})
    if printed.getvalue() != shown:
        sys.exit(f"{sys.argv[1]} shows:\n{shown}but its example prints:\n{printed.getvalue()}")
