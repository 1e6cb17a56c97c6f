#!/usr/bin/env python3
"""The checks of the headers' comments must bark: at a name that is gone, at an example that would not be compiled, at
a contract that got poorer, at a name that no include brings."""
import tomllib
import unittest

import header_contract
import header_examples
import header_includes
import header_names
import small_house

HEADER = """// What it is.
//
//   const Ball ball(radius);
//   ball.Volume();      // m^3
//
// Units: m. Failure: none.
#pragma once

// One that rolls.
class Ball {
 public:
  explicit Ball(double radius);
  // m^3.
  double Volume() const;
  double Area() const;

 private:
  double Hidden() const;
};
"""


class HeadersTest(small_house.HouseTest):
    def names(self, comment):
        root = self.house({"relm/ball.h": HEADER, "docs/sweep.md": "", "relm/a.h": f"// {comment}\n#pragma once\n"})
        return [line.split(": ")[1] for line in header_names.strangers(root)]

    def test_a_name_that_is_gone_is_found(self):
        self.assertEqual(self.names("See Rolled(), kLargest and BallBearing."),
                         ["nothing is called Rolled", "nothing is called kLargest", "nothing is called BallBearing"])

    def test_a_file_that_is_gone_is_found(self):
        self.assertEqual(self.names("See gone.h, fusion/ball.h and models.md."),
                         ["there is no gone.h", "there is no fusion/ball.h", "there is no models.md"])

    def test_what_exists_is_not_found(self):
        self.assertEqual(self.names("See Volume(), ball.h, relm/ball.h and docs/sweep.md; export_NAME.cpp."), [])

    def lacks(self, includes, code):
        """The names that a header of relm/ lacks, beside one of recording/ and one of relm/ that includes it."""
        root = self.house({
            "recording/recording.h": "#pragma once\nnamespace abbe::recording {\nstruct Recording {};\n"
                                     "Recording Read(const char* path);\ninline constexpr int kRows = 3;\n}\n",
            "relm/ball.h": '#pragma once\n#include "recording/recording.h"\n' + HEADER.split("#pragma once")[1].replace(
                "class Ball", "namespace abbe::relm {\nclass Ball") + "}\n",
            "relm/a.h": f"#pragma once\n{includes}\nnamespace abbe::relm {{\n{code}\n}}\n"})
        return [line.split(" uses ")[1].split(" and ")[0] for line in header_includes.complaints(root)]

    def test_a_name_without_its_header_is_found(self):
        self.assertEqual(self.lacks("", "recording::Recording Of(Ball ball);"), ["recording::Recording", "Ball"])
        self.assertEqual(self.lacks("", "inline int rows = recording::kRows; // Ball"), ["recording::kRows"])
        self.assertEqual(self.lacks("#include <vector>", "std::vector<Eigen::Vector3d> Points(std::string text);"),
                         ["std::string", "Eigen::"])

    def test_a_name_that_comes_with_another_header_is_not_found(self):
        self.assertEqual(self.lacks('#include "relm/ball.h"', "recording::Recording Of(Ball ball);"), [])
        self.assertEqual(self.lacks("#include <string>", 'inline std::string ball = "Ball";'), [])

    def test_a_declaration_in_advance_will_do(self):
        self.assertEqual(self.lacks("", "class Ball;\nvoid Roll(Ball& ball);"), [])

    def test_an_example_becomes_a_function_at_its_line(self):
        text, count = header_examples.source(self.house({"relm/ball.h": HEADER}), {"relm": {"ball.h": "double radius"}})
        self.assertEqual(count, 1)
        self.assertRegex(text, r'Example1\(double radius\) \{\n#line 3 ".*ball.h"\nconst Ball ball\(radius\);')

    def test_a_definition_stands_beside_the_function(self):
        definitions, statements = header_examples.parts(["struct A {", "  int b;", "};", "A a;"])
        self.assertEqual((definitions, statements), (["struct A {", "  int b;", "};"], ["A a;"]))

    def test_a_formula_is_no_example(self):
        self.assertEqual(list(header_examples.examples("//   gap = m . (corner - p) / (m . w)\n")), [])

    def test_the_list_of_examples_that_wait_only_gets_shorter(self):
        self.assertEqual(tomllib.loads(header_examples.TABLE.read_text())["skipped"], [])

    def test_the_contract_is_counted(self):
        self.assertEqual(header_contract.parts_of(HEADER), {"units", "failure"})
        self.assertEqual(list(header_contract.functions(HEADER)), [("Volume", True), ("Area", False)])

    def test_a_poorer_contract_is_found(self):
        wanted = header_contract.recorded("| units | of lengths | 48 % |\n| frames | | 19 % |\n")
        self.assertEqual(wanted, {"units": 48, "frames": 19})
        self.assertEqual(list(header_contract.shortfalls({"units": 47, "frames": 19}, wanted)),
                         ["units: 47 %, recorded 48 %"])


if __name__ == "__main__":
    unittest.main()
