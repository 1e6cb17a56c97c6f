"""A map, a calibration and their certificates, made once for the tests of `abbe certificate`."""
import json
import pathlib
import tempfile

from program_case import MACHINE, ProgramCase

DATA = """
[certificate]
number = "2026-0417"
performed = ["2026-11-21", "2026-11-22"]
issued = "2026-11-25"
location = "customer"
[certificate.laboratory]
name = "Messlabor Süd & Söhne"
code = "D-K-00000"
street = "Werkstraße 1"
post_code = "70173"
city = "Stuttgart"
country = "DE"
[certificate.customer]
name = "Mill & Sons <Ltd>"
city = "Leeds"
country = "GB"
[[certificate.person]]
name = "A. Metrologist"
role = "head of the laboratory"
signs = true
[certificate.item]
name = "demo mill"
manufacturer = "Example Machines"
serial = "4711"
[[certificate.instrument]]
name = "hole plate"
serial = "P 17"
certificate = "PTB 5.3-1234"
certificate_by = "PTB"
[[certificate.instrument]]
name = "touch probe"
serial = "TP-9"
certificate = "C-12"
certificate_by = "Probe Lab"
certificate_sha256 = "%s"
[[certificate.condition]]
name = "air temperature"
text = "20.1 +- 0.3 degC"
""" % ("0" * 63 + "1")
LIMITS = """
[limits]
EYX = { straightness_um = 50.0 }
EXX = { range_um = 0.001 }
C0Y = { urad = %r }
"""


class CertificateCase(ProgramCase):
    command = "certificate"

    @classmethod
    def setUpClass(cls):
        folder = tempfile.TemporaryDirectory()
        cls.addClassCleanup(folder.cleanup)
        cls.made = pathlib.Path(folder.name)
        case = cls()
        case.path = cls.made
        # Its axes count as the tool goes, as ISO 841 has it: QIF takes no other.
        mill = pathlib.Path(MACHINE).read_text().replace('positive = "carriage"', 'positive = "tool"')
        cls.machine = cls.made / "mill.toml"
        cls.machine.write_text(mill)
        case.rig_record("plate.csv", "--plate", machine=cls.machine)
        case.done(cls.made / "plate.csv", "--machine", cls.machine, "-o", cls.made / "map.toml", "--json",
                  cls.made / "plate.json", "--quiet", command="plate")
        case.rig_record("cube.csv", "--course", "cube", "--dwell", 0.1, "--feed", 6000, "--size", 45, "--points",
                        "4,4,4", "--reference")
        case.done(cls.made / "cube.csv", "--machine", MACHINE, "-o", cls.made / "linkage.toml", "--json",
                  cls.made / "calibrate.json", "--folds", 1, "--quiet", command="calibrate")
        cls.result = json.loads((cls.made / "plate.json").read_text())
        # A limit on which the squareness lies within its U95: undecided.
        limit = abs(1e6 * cls.result["map"]["errors"]["C0Y"]["value"]) - 0.001
        cls.machine.write_text(mill + LIMITS % limit + DATA)

        # The linkage was measured on the machine as it stands.
        cls.linkage_machine = cls.made / "linkage_machine.toml"
        cls.linkage_machine.write_text(pathlib.Path(MACHINE).read_text() + DATA)

    def certify(self, *arguments, of="map.toml", result="plate.json", name="certificate.xml", machine=None):
        """The path of a certificate, and what the program prints."""
        out = self.path / name
        result = result if isinstance(result, pathlib.Path) else self.made / result
        return out, self.done(self.made / of, "--result", result, "--machine", machine or self.machine, "-o", out,
                              *arguments)
