"""A house of a few files, for the watches to look at."""
import pathlib
import tempfile
import unittest


class HouseTest(unittest.TestCase):
    def house(self, files):
        """A folder with these files, name -> text, until the test is over."""
        root = pathlib.Path(self.enterContext(tempfile.TemporaryDirectory()))
        for name, text in files.items():
            (root / name).parent.mkdir(parents=True, exist_ok=True)
            (root / name).write_text(text)
        return root
