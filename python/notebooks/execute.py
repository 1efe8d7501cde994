"""Execute notebooks, each from its first cell, and compare what they print with what they store.

    python3 execute.py [--write] NOTEBOOK...

--write stores what the cells print and draw now, instead. Cells with the tag `times` may print something else each
time. Exit status 1 where a cell fails or prints something else, 77 where nbclient, ipykernel, matplotlib or scipy
is not installed.
"""

import os
import sys
import tempfile

try:
    import matplotlib  # noqa: F401
    import ipykernel  # noqa: F401
    import jupyter_client
    import nbclient
    import nbformat
    import scipy.io  # noqa: F401
except ImportError as error:
    print(f"skipped: {error}; apt install python3-nbclient python3-ipykernel python3-matplotlib python3-scipy")
    sys.exit(77)


def text(cell):
    """What a code cell prints."""
    return "".join(output.text for output in cell.outputs if output.output_type == "stream")


def execute(path, folder):
    """The notebook as it is stored and as executed in a folder."""
    stored = nbformat.read(path, 4)
    executed = nbformat.reads(nbformat.writes(stored), 4)
    # Sockets in the folder, not ports that others may take.
    manager = jupyter_client.AsyncKernelManager(
        kernel_name="python3", transport="ipc", connection_file=os.path.join(folder, "kernel.json")
    )
    nbclient.NotebookClient(
        executed, km=manager, timeout=300, record_timing=False, resources={"metadata": {"path": folder}}
    ).execute(cleanup_kc=True)
    return stored, executed


def main():
    arguments = sys.argv[1:]
    write = arguments[:1] == ["--write"]
    paths = arguments[write:]
    if not paths:
        sys.exit(__doc__)
    failed = False
    for path in paths:
        with tempfile.TemporaryDirectory() as folder:
            os.environ["IPYTHONDIR"] = os.environ["MPLCONFIGDIR"] = folder  # not the user's settings
            os.environ["PYDEVD_DISABLE_FILE_VALIDATION"] = "1"  # no remarks of the debugger
            try:
                stored, executed = execute(path, folder)
            except nbclient.exceptions.CellExecutionError as error:
                print(f"{path}: {error}")
                failed = True
                continue
        for number, cell in enumerate(executed.cells, 1):
            if cell.cell_type != "code":
                continue
            before = text(stored.cells[number - 1])
            if not write and "times" not in cell.metadata.get("tags", []) and text(cell) != before:
                print(f"{path}: cell {number} shows:\n{before}but prints:\n{text(cell)}")
                failed = True
        if write:
            executed.metadata = {"kernelspec": stored.metadata.kernelspec, "language_info": {"name": "python"}}
            nbformat.write(executed, path)
    sys.exit(failed)


main()
