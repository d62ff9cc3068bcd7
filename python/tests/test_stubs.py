# SPDX-FileCopyrightText: 2026 The adit authors
# SPDX-License-Identifier: MIT
"""The stubs describe the module as it is: every name, member and argument, and none that does not exist."""
import ast
import os
import re
import subprocess
import sys
import unittest
from pathlib import Path

import adit

STUB_FILE = Path(adit.__file__).parent / "__init__.pyi"
STUB = ast.parse(STUB_FILE.read_text())
EXAMPLE = Path(__file__).parents[2] / "examples" / "maps_in_python.py"


def public(names):
    return {name for name in names if not name.startswith("_")}


def arguments_of(function):
    args = function.args
    return [arg.arg for arg in args.posonlyargs + args.args + args.kwonlyargs if arg.arg != "self"]


def arguments_in(doc):
    """Of the first signature in a docstring of pybind11."""
    return [name for name in re.findall(r"(?<=[( ])([A-Za-z_]\w*): ", doc) if name != "self"]


class Stubs(unittest.TestCase):
    def test_every_name_is_there(self):
        classes = {node.name for node in STUB.body if isinstance(node, ast.ClassDef)}
        functions = {node.name for node in STUB.body if isinstance(node, ast.FunctionDef)}
        self.assertEqual(classes | functions, set(adit.__all__))

    def test_every_member_is_there(self):
        for node in STUB.body:
            if not isinstance(node, ast.ClassDef) or node.name == "Error":
                continue
            described = {item.name for item in node.body if isinstance(item, ast.FunctionDef)}
            described |= {item.target.id for item in node.body if isinstance(item, ast.AnnAssign)}
            there = vars(getattr(adit, node.name))
            self.assertEqual(public(described), public(there), node.name)
            for special in ("__len__", "__getitem__"):
                self.assertEqual(special in described, special in there, f"{node.name}.{special}")

    def test_types_fit_together_and_the_example(self):
        # matplotlib has no types.
        mypy = [sys.executable, "-m", "mypy", "--strict", "--ignore-missing-imports", "--cache-dir", os.devnull]
        paths = {**os.environ, "MYPYPATH": str(STUB_FILE.parents[1])}
        for file in (STUB_FILE, EXAMPLE):
            run = subprocess.run([*mypy, file], env=paths, capture_output=True, text=True, check=False)
            self.assertEqual(run.returncode, 0, run.stdout + run.stderr)

    def test_arguments_have_the_same_names(self):
        for node in STUB.body:
            if isinstance(node, ast.FunctionDef):
                self.assertEqual(arguments_of(node), arguments_in(signature_of(getattr(adit, node.name))), node.name)
            elif isinstance(node, ast.ClassDef):
                for item in node.body:
                    if isinstance(item, ast.FunctionDef) and not item.decorator_list and item.name != "__len__":
                        function = getattr(getattr(adit, node.name), item.name)
                        self.assertEqual(arguments_of(item), arguments_in(signature_of(function)), f"{node.name}.{item.name}")


def signature_of(function):
    lines = function.__doc__.splitlines()
    return next((line for line in lines if line.startswith("1. ")), lines[0])


if __name__ == "__main__":
    unittest.main()
