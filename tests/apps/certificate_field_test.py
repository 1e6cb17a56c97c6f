#!/usr/bin/env python3
"""The certificates against the official schemas (DCC 3.2.0 with D-SI, QIF 3.0), by xmllint, without a network."""
import os
import pathlib
import shutil
import subprocess
import unittest

from certificate_case import CertificateCase

ROOT = pathlib.Path(__file__).resolve().parents[2]
SCHEMAS = pathlib.Path(os.environ.get("ABBE_FIELD_DATA", ROOT.parent / "shared/data")) / "schemas"


@unittest.skipUnless(SCHEMAS.exists(), "field data not found")
@unittest.skipUnless(shutil.which("xmllint"), "xmllint not found: apt-get install libxml2-utils")
class OfficialSchemas(CertificateCase):
    def lint(self, path, schema):
        return subprocess.run(["xmllint", "--nonet", "--noout", "--schema", SCHEMAS / schema, path],
                              capture_output=True, text=True)

    def valid(self, path, schema):
        run = self.lint(path, schema)
        self.assertEqual(run.returncode, 0, "\n".join(run.stderr.splitlines()[:10]))
        # A schema that takes everything would prove nothing.
        broken = self.path / "broken.xml"
        broken.write_text(path.read_text().replace("uniqueIdentifier", "anything").replace("XLinearity", "anything"))
        self.assertNotEqual(self.lint(broken, schema).returncode, 0)

    def test_the_map(self):
        self.valid(self.certify()[0], "dcc/dcc.xsd")

    def test_the_linkage(self):
        self.valid(self.certify(of="linkage.toml", result="calibrate.json", machine=self.linkage_machine)[0], "dcc/dcc.xsd")

    def test_qif(self):
        self.valid(self.certify("--format", "qif", name="machine.qif")[0], "qif/QIFDocument.xsd")


if __name__ == "__main__":
    unittest.main()
