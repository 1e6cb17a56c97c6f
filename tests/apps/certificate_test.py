#!/usr/bin/env python3
"""`abbe certificate` as a reader of XML sees it: values, U95 and the covariance by xml.etree against the map
file and its JSON, the decision rule computed here, and what is refused.

    ABBE=path/to/abbe ABBE_MACHINE=machine.toml certificate_test.py
"""
import json
import re
import tomllib
import unittest
import xml.etree.ElementTree as ET

import numpy as np

from certificate_case import CertificateCase

DCC, SI, QIF = "{https://ptb.de/dcc}", "{https://ptb.de/si}", "{http://qifstandards.org/xsd/qif3}"
ROUNDING = 2e-12  # of the curves in the JSON
FIELDS = {"XLinearity": "EXX", "XAxisRoll": "EAX", "XAxisPitch": "EBX", "XAxisYaw": "ECX", "YAxisRoll": "EBY",
          "YAxisPitch": "EAY", "ZAxisRoll": "ECZ", "XAxisStraightnessY": "EYX", "ZAxisStraightnessX": "EXZ"}


def text(element, path):
    return element.find(path.replace("dcc:", DCC).replace("si:", SI)).text


def numbers(element, path):
    return np.array([float(word) for word in text(element, path).split()])


class CertificateTest(CertificateCase):
    def results(self, root):
        return {text(each, "dcc:name/dcc:content"): each for each in root.iter(DCC + "result")}

    def test_the_21_errors_are_those_of_the_map(self):
        path, _ = self.certify("--points", 61)
        results = self.results(ET.parse(path).getroot())
        for name, curve in self.result["map"]["errors"].items():
            quantities = list(results[name].iter(DCC + "quantity"))
            values = numbers(quantities[-1], ".//si:valueXMLList")
            U95 = numbers(quantities[-1], ".//si:uncertaintyXMLList")
            np.testing.assert_allclose(values, np.atleast_1d(curve["value"]), rtol=0, atol=ROUNDING)
            np.testing.assert_allclose(U95, 2 * np.atleast_1d(curve["u"]), rtol=0, atol=2 * ROUNDING)
            self.assertEqual(set(text(quantities[-1], ".//si:coverageFactorXMLList").split()), {"2"})
            unit = {"m": r"\metre", "rad": r"\radian"}[curve["unit"]]
            self.assertEqual(set(text(quantities[-1], ".//si:unitXMLList").split()), {unit})
            if "positions" in curve:
                np.testing.assert_allclose(numbers(quantities[0], ".//si:valueXMLList"), curve["positions"], atol=ROUNDING)

    def test_the_covariance_is_that_of_the_map_to_the_last_bit(self):
        path, _ = self.certify()
        kept = tomllib.loads((self.made / "map.toml").read_text())
        root = ET.parse(path).getroot()
        joint = self.results(root)["Parameters with covariance"]
        self.assertEqual(text(joint, ".//si:labelXMLList").split(), kept["covariance"]["names"])
        coefficients = [number for error in kept["error"] for number in error["coefficients"]] + kept["squareness"]
        self.assertEqual(list(numbers(joint, ".//si:valueXMLList")), coefficients)
        size = len(coefficients)
        rows = iter(kept["covariance"]["rows"])
        expected = np.zeros((size, size))
        for i in range(size):
            for j in range(i + 1):
                expected[i, j] = expected[j, i] = next(rows)
        columns = [[float(entry.text) for entry in column.iter(SI + "value")] for column in joint.iter(SI + "column")]
        self.assertTrue((np.array(columns) == expected).all())
        units = {unit.text for unit in joint.find(f".//{SI}covarianceMatrix").iter(SI + "unit")}
        self.assertEqual(units, {r"\metre\metre", r"\metre\radian", r"\radian\metre", r"\radian\radian"})

    def test_it_says_who_what_when_and_with_which_instruments(self):
        root = ET.parse(self.certify()[0]).getroot()
        self.assertEqual(text(root, ".//dcc:uniqueIdentifier"), "2026-0417")
        self.assertEqual(text(root, ".//dcc:calibrationLaboratory/dcc:contact/dcc:name/dcc:content"), "Messlabor Süd & Söhne")
        self.assertEqual(text(root, ".//dcc:customer/dcc:name/dcc:content"), "Mill & Sons <Ltd>")
        self.assertEqual(text(root, ".//dcc:item/dcc:identifications/dcc:identification/dcc:value"), "4711")
        equipment = root.findall(f".//{DCC}measuringEquipment")
        self.assertEqual([text(each, "dcc:name/dcc:content") for each in equipment], ["hole plate", "touch probe"])
        self.assertEqual(text(equipment[1], "dcc:certificate/dcc:referralID"), "C-12")
        said = [each.text for each in root.iter(DCC + "content")]
        self.assertIn("Simulated recordings: no machine was measured", said)
        self.assertIn("20.1 +- 0.3 degC", said)

    def test_conformity_follows_the_decision_rule(self):
        path, printed = self.certify()
        seen = {}
        for meta in ET.parse(path).getroot().iter(DCC + "metaData"):
            value, limit = meta.findall(f".//{SI}real")
            y, U, L = (float(text(value, "si:value")), float(text(value, ".//si:uncertainty")), float(text(limit, "si:value")))
            status = "pass" if abs(y) + U <= L else "fail" if abs(y) - U > L else "conditionalPass" if abs(y) <= L else "conditionalFail"
            name = text(meta, "dcc:name/dcc:content")
            unit = r"\micro\radian" if name.split(",")[0].endswith("urad") else r"\micro\metre"
            self.assertEqual([text(value, "si:unit"), text(limit, "si:unit")], [unit, unit], name)
            self.assertEqual(text(meta, "dcc:conformity"), status, name)
            self.assertIn(status, printed)
            seen[name.split(",")[0]] = status
        self.assertEqual(seen, {"EYX.straightness_um": "pass", "EXX.range_um": "fail", "C0Y.urad": "conditionalFail"})

    def test_beside_a_contradiction_no_conformity_is_stated(self):
        doubted = self.path / "doubted.json"
        doubted.write_text(json.dumps({**self.result, "contradictions": ["plate.csv set-up 2"], "widened": 3.0}))
        path, printed = self.certify(result=doubted)
        root = ET.parse(path).getroot()
        self.assertEqual(list(root.iter(DCC + "conformity")), [])
        self.assertIn("NO CONFORMITY IS STATED: Contradiction: plate.csv set-up 2", printed)
        self.assertTrue(any("plate.csv set-up 2 disagrees" in (each.text or "") for each in root.iter(DCC + "content")))
        diagnosis = self.path / "diagnosis.json"
        diagnosis.write_text(json.dumps({"command": "diagnose", "machine": self.result["machine"], "verdict": "unexplained",
                                         "unexplained": [{"variable": "time", "object": "X", "amplitude": 2.0, "unit": "um"}]}))
        path, printed = self.certify("--diagnosis", diagnosis, name="again.xml")
        self.assertEqual(list(ET.parse(path).getroot().iter(DCC + "conformity")), [])
        self.assertIn("Unexplained: time of X, 2 um", printed)

    def test_qif_holds_the_errors_of_the_tool(self):
        path, _ = self.certify("--format", "qif", "--points", 61, name="machine.qif")
        root = ET.parse(path).getroot()
        self.assertEqual(len(root.find(f".//{QIF}CartesianCMMFPSTest")), 21)
        errors = self.result["map"]["errors"]
        # X and Y carry the workpiece and count as the tool goes: but for the positioning, the tool goes the other way.
        for field, name in FIELDS.items():
            element = root.find(f".//{QIF}{field}")
            values = np.array([float(word) for word in element.find(QIF + "RangeValues").text.split()])
            self.assertEqual(int(element.get("n")), len(values))
            sign = -1 if name[2] in "XY" and field[1:] != "Linearity" else 1
            expected = sign * np.array(errors[name]["value"])
            if name == "EYX":  # the table's turn about Z moves the tool by the way that X has gone
                expected -= np.array(errors["EYX"]["positions"]) * np.array(errors["ECX"]["value"])
            # All to second order: 60 mm (100 urad)^2.
            np.testing.assert_allclose(values, expected, rtol=0, atol=0.06 * 1e-8 + ROUNDING, err_msg=name)
        for field, name, sign in (("XYSquareness", "C0Y", 1), ("XZSquareness", "B0Z", -1), ("YZSquareness", "A0Z", 1)):
            self.assertAlmostEqual(float(root.find(f".//{QIF}{field}").text), sign * errors[name]["value"], delta=ROUNDING)
        U95 = next(each.get("value") for each in root.iter(QIF + "AttributeStr") if each.get("name") == "U95 EAX")
        np.testing.assert_allclose([float(word) for word in U95.split()], 2 * np.array(errors["EAX"]["u"]), rtol=1e-6, atol=2 * ROUNDING)

    def test_the_linkage_with_its_covariance(self):
        path, _ = self.certify(of="linkage.toml", result="calibrate.json", machine=self.linkage_machine)
        kept = tomllib.loads((self.made / "linkage.toml").read_text())
        joint = self.results(ET.parse(path).getroot())["Parameters with covariance"]
        labels = [label.replace("%20", " ") for label in text(joint, ".//si:labelXMLList").split()]
        self.assertEqual(labels, kept["covariance"]["names"])
        columns = [float(entry.text) for column in joint.iter(SI + "column") for entry in column.iter(SI + "value")]
        self.assertEqual(columns, kept["covariance"]["rows"])
        si = {"um": 1e-6, "urad": 1e-6, "ppm/degC": 1e-6}
        printed = {each["name"]: each["value"] * si[each["unit"]] for each in kept["parameter"]}
        np.testing.assert_allclose(numbers(joint, ".//si:valueXMLList"), [printed[name] for name in labels], rtol=1e-15)
        self.refuse(self.made / "linkage.toml", "--result", self.made / "calibrate.json", "--machine", self.linkage_machine,
                    "--format", "qif", "-o", self.path / "l.qif", saying=["linkage", "--format dcc"])

    def test_refusals_say_what_to_write_where(self):
        of, result = self.made / "map.toml", self.made / "plate.json"
        out = ("-o", self.path / "c.xml")
        for line, key in (("number = .*\n", "certificate.number"), ("serial = \"4711\"\n", "certificate.item.serial"),
                          ("city = \"Leeds\"\n", "certificate.customer.city")):
            other = self.path / "other.toml"
            other.write_text(re.sub(line, "", self.machine.read_text(), count=1))
            self.refuse(of, "--result", result, "--machine", other, *out, saying=[f"{other}", f"{key}: is missing"])
        bare = self.path / "bare.toml"
        bare.write_text(self.machine.read_text().split("[certificate]")[0])
        self.refuse(of, "--result", result, "--machine", bare, *out, saying=["[certificate]", "docs/certificate.md"])
        own = self.path / "own.toml"
        own.write_text("[certificate]" + self.machine.read_text().split("[certificate]")[1])
        self.done(of, "--result", result, "--machine", bare, "--data", own, *out)
        strange = json.loads(result.read_text())
        strange["map"]["errors"]["EYX"]["value"][30] += 1e-9
        (self.path / "strange.json").write_text(json.dumps(strange))
        self.refuse(of, "--result", self.path / "strange.json", "--machine", self.machine, *out,
                    saying=["strange.json", "EYX differs by 1e-09", "--json of the command"])
        self.assertEqual(self.run_program(of, "--result", result, "--machine", self.machine, "-o", result).returncode, 2)


if __name__ == "__main__":
    unittest.main()
