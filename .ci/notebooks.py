#!/usr/bin/env python3
"""Runs every notebook of a folder from its first cell to its last; ends with 1 if one fails.

    notebooks.py FOLDER [--write]

With --write the results are kept in the notebooks."""

import sys
from pathlib import Path

import nbformat
from nbclient import NotebookClient
from nbclient.exceptions import CellExecutionError


def run(path, write):
    book = nbformat.read(path, as_version=4)
    client = NotebookClient(book, timeout=600, kernel_name="python3", resources={"metadata": {"path": str(path.parent)}})
    try:
        client.execute()
    except CellExecutionError as error:
        print(f"{path}: {error}")
        return False
    if write:
        for cell in book.cells:
            # When a cell ran says nothing, and would change with every run.
            cell.metadata.pop("execution", None)
        nbformat.write(book, path)
    print(f"{path}: {sum(cell.cell_type == 'code' for cell in book.cells)} cells ran")
    return True


def main():
    paths = sorted(Path(sys.argv[1]).glob("*.ipynb"))
    good = [run(path, "--write" in sys.argv[2:]) for path in paths]
    return 0 if good and all(good) else 1


sys.exit(main())
