"""The example of docs/python.md prints what the page shows. Usage: test_python_page.py PAGE"""

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
example, shown = re.search(r"```python\n(.*?)```\n\n```\n(.*?)```\n", page, re.S).groups()
printed = io.StringIO()
with contextlib.redirect_stdout(printed):
    exec(example, {"__name__": "example"})
if printed.getvalue() != shown:
    sys.exit(f"{sys.argv[1]} shows:\n{shown}but its example prints:\n{printed.getvalue()}")
