#!/usr/bin/env python3
"""The watches over pages must bark: over the promises at a test, a function, a title, a target or a file that is gone,
over the recordings at a key that the page lacks, that nothing reads, or whose number is another."""
import unittest

import promises
import recording_keys
import small_house

HEAD = "| promise | what it was before | now | held by |\n|---|---|---|---|\n"


class PromisesTest(small_house.HouseTest):
    def complaints(self, held_by, now="kept"):
        root = self.house({
            "docs/promises.md": HEAD + f"| a thing holds | not | {now} | {held_by} |\n",
            "tests/apps/CMakeLists.txt": "program_test(sweep hal)\nforeach(check arrows promises)\n"
                                         "add_test(NAME package.find_package COMMAND a)\n",
            "tests/apps/sweep_test.py": "class T:\n    def test_slips_are_refused(self):\n        pass\n",
            "tests/hal/a_test.cpp": "TEST(Source, Holds) {}\nTEST_F(SourceTest, HoldsToo) {}\n",
            "tests/hal/b_test.cpp": "TEST(Other, Holds) {}\n",
            "tests/report/page.test.mjs": "test('the title says when', () => {});\n",
            "fuzz/candump.cpp": "", "fuzz/corpus/a": ""})
        return [line.split(": ", 1)[1] for line in promises.complaints(root)]

    def test_what_is_gone_is_found(self):
        for held_by, wrong in (
                ("`Source.Holding`", "there is no test Source.Holding"),
                ("`Other.Holds` (hal/a_test.cpp)", "there is no test Other.Holds in hal/a_test.cpp"),
                ("`Source.Holds` (hal/c_test.cpp)", "there is no file hal/c_test.cpp"),
                ("`Third`", "there is no test Third"),
                ("`sweep.program` slips_are_taken", "sweep_test.py has no test_slips_are_taken"),
                ("`Source.Holds`; slips_are_refused", "slips_are_refused has no program before it"),
                ("`package.find_others`", "ctest knows no package.find_others"),
                ("`architecture.nothing`", "ctest knows no architecture.nothing"),
                ("`report.page` the title says who", 'report.page has no test "the title says who"'),
                ("`fuzz.unit.modbus`", "there is no fuzzing target modbus")):
            self.assertEqual(self.complaints(held_by), [wrong])
        self.assertEqual(self.complaints("`reduce.program` slips_are_refused"),
                         ["ctest knows no reduce.program", "reduce.program has no script"])
        self.assertEqual(self.complaints("`Source.Holds`", now="`fuzz/crashes`"), ["there is no fuzz/crashes"])

    def test_what_exists_is_not_found(self):
        self.assertEqual(self.complaints(
            "`Source.Holds`, `SourceTest.HoldsToo` (hal/a_test.cpp); `Other`; `sweep.program` slips_are_refused, 16 "
            "commands; `package.find_package`; `architecture.promises`; `report.page` the title says when; "
            "`fuzz.unit.TARGET`; `fuzz.unit.candump` (fuzz/candump.cpp)", now="`fuzz/corpus`"), [])

    def keys(self, code, page):
        root = self.house({"probes/a.cpp": code, "docs/recordings.md": f"## The header\n\n{page}\n\n## The columns\n"})
        return [line.split(": ", 1)[-1] for line in recording_keys.complaints(root)]

    def test_keys_of_recordings(self):
        code = 'constexpr double kUsual = 0.1;\nr.HeaderNumber("sweep.settle_s", 0.0).value_or(kUsual);\n'
        self.assertEqual(self.keys(code, "| `sweep.settle_s` | readings begin to count (0.1) |"), [])
        self.assertEqual(self.keys(code, "| `kind` | what |"), [
            "docs/recordings.md lacks `sweep.settle_s`, which probes/a.cpp asks for", "`kind` is nowhere in the code"])
        self.assertEqual(self.keys(code, "| `sweep.settle_s` | readings begin to count (0.15) |"), [
            "`sweep.settle_s` is 0.1 where it is absent (probes/a.cpp), and the page does not say so"])


if __name__ == "__main__":
    unittest.main()
