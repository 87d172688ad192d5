"""pelagic.pyi, which the build writes beside the module: every public name and signature, types that mean something,
and docstrings."""

import ast
import inspect
import os
import re
import typing
import unittest

import pelagic

PATH = os.path.join(os.path.dirname(pelagic.__file__), "pelagic.pyi")


def signature_of(value):
    """The names of the parameters that the module itself tells, and whether each has a default."""
    text = re.sub(r"'[^']*'", "''", (value.__doc__ or "").partition("\n")[0])
    inside = re.search(r"\((.*)\) ->", text)[1]
    while re.search(r"[\[(][^\[\]()]*[\])]", inside):
        inside = re.sub(r"[\[(][^\[\]()]*[\])]", "", inside)
    parts = [part.strip() for part in inside.split(",") if part.strip() not in ("", "*")]
    return [(re.split(r"[:= ]", part)[0], "=" in part) for part in parts]


def declared(function):
    arguments = function.args
    plain = arguments.args
    defaults = [False] * (len(plain) - len(arguments.defaults)) + [True] * len(arguments.defaults)
    return [(a.arg, d) for a, d in zip(plain, defaults)] + [
        (a.arg, d is not None) for a, d in zip(arguments.kwonlyargs, arguments.kw_defaults)]


def public(owner):
    return {name: value for name, value in vars(owner).items() if not name.startswith("_")}


class Stubs(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        with open(PATH, encoding="utf-8") as file:
            cls.text = file.read()
        cls.tree = ast.parse(cls.text)
        cls.top = {node.name: node for node in cls.tree.body if isinstance(node, (ast.ClassDef, ast.FunctionDef))}

    def members(self, name):
        found = {}
        for node in self.top[name].body:
            if isinstance(node, ast.FunctionDef):
                found[node.name] = node
            elif isinstance(node, ast.AnnAssign):
                found[node.target.id] = node
        return found

    def test_every_public_name_is_there_and_nothing_else(self):
        self.assertEqual(set(self.top), set(public(pelagic)))
        for name, value in public(pelagic).items():
            if not inspect.isclass(value) or issubclass(value, (tuple, BaseException)):
                continue
            expected = set(public(value))
            if "->" in (value.__init__.__doc__ or "") and "__init__" in vars(value):
                expected.add("__init__")
            self.assertEqual({m for m in self.members(name) if m != "__eq__"}, expected, name)

    def test_signatures_are_the_modules(self):
        checked = 0
        for name, value in public(pelagic).items():
            if isinstance(self.top[name], ast.FunctionDef):
                self.assertEqual(declared(self.top[name]), signature_of(value), name)
                checked += 1
                continue
            for member, node in self.members(name).items():
                inside = vars(value).get(member)
                if not isinstance(node, ast.FunctionDef) or isinstance(inside, property) or member == "__eq__":
                    continue
                inside = inside.__func__ if isinstance(inside, staticmethod) else inside
                ours = [(a, d) for a, d in declared(node) if a != "self"]
                self.assertEqual(ours, [(a, d) for a, d in signature_of(inside) if a != "self"], f"{name}.{member}")
                checked += 1
        self.assertGreater(checked, 30)

    def test_named_tuples_have_their_fields(self):
        for key in pelagic.keys():
            if key["entry"]:
                fields = getattr(pelagic, key["entry"])
                node = self.members(key["entry"])
                self.assertEqual(tuple(node), fields._fields)
                self.assertEqual({n for n, each in node.items() if each.value is not None}, set(fields._field_defaults))

    def test_types_say_what_things_are(self):
        namespace = {}
        exec(compile("from __future__ import annotations\n" + self.text, PATH, "exec"), namespace)
        for name, value in public(pelagic).items():
            typing.get_type_hints(namespace[name], namespace)  # every name in them is known
            functions = [namespace[name]] if not inspect.isclass(namespace[name]) else [
                getattr(each, "fget", each) for each in vars(namespace[name]).values()]
            for function in functions:
                function = getattr(function, "__func__", function)
                if not inspect.isfunction(function) or function.__name__ == "__eq__":
                    continue
                for parameter, kind in typing.get_type_hints(function, namespace).items():
                    where = f"{name}.{function.__name__}: {parameter}"
                    self.assertNotIn(kind, (object, dict, list, tuple), where)

    def test_everything_is_documented(self):
        for name, node in self.top.items():
            self.assertTrue(ast.get_docstring(node), name)
            if not isinstance(node, ast.ClassDef) or issubclass(getattr(pelagic, name), (tuple, BaseException)):
                continue
            for member, inside in self.members(name).items():
                if isinstance(inside, ast.FunctionDef) and not member.startswith("_"):
                    self.assertTrue(ast.get_docstring(inside), f"{name}.{member}")


if __name__ == "__main__":
    unittest.main()
