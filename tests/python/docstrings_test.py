#!/usr/bin/env python3
"""The docstrings of the module: everything has one that says something, and its examples run.

    PYTHONPATH=build/dev/python docstrings_test.py
"""
import doctest
import inspect
import unittest

import abbe


def documented():
    """(name, object, where) of everything public."""
    for name, thing in vars(abbe).items():
        if name.startswith("_"):
            continue
        yield name, thing
        if inspect.isclass(thing):
            yield from ((f"{name}.{part}", getattr(thing, part)) for part in vars(thing) if not part.startswith("_"))


class DocstringsTest(unittest.TestCase):
    def test_examples_print_what_they_show(self):
        runner, examples = doctest.DocTestRunner(), 0
        for name, thing in documented():
            test = doctest.DocTestParser().get_doctest(thing.__doc__ or "", {}, name, None, None)
            examples += len(test.examples)
            runner.run(test)
        self.assertGreater(examples, 5)
        self.assertEqual(runner.summarize().failed, 0)

    def test_functions_and_classes_say_what_they_do(self):
        for name, thing in documented():
            if inspect.isclass(thing) or callable(thing):
                self.assertRegex(thing.__doc__ or "", r"\w`?\.", name)

    def test_signatures_name_the_arguments(self):
        for name, thing in documented():
            if callable(thing) and not inspect.isclass(thing):
                self.assertNotIn("args", str(inspect.signature(thing)), name)


if __name__ == "__main__":
    unittest.main()
