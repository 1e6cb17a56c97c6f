#!/usr/bin/env python3
"""The watch must bark: a forbidden include, a library behind a gate, an unknown folder."""
import unittest

import arrows
import small_house


class ArrowsTest(small_house.HouseTest):
    def test_an_arrow_that_goes_back_is_found(self):
        root = self.house({"geometry/rotation.h": '#include "probes/head_model.h"\n'})
        self.assertEqual(len(list(arrows.broken_arrows(root))), 1)

    def test_the_rig_may_not_see_a_model(self):
        root = self.house({"rig/world.cpp": '#include "geometry/rotation.h"\n'})
        self.assertEqual(len(list(arrows.broken_arrows(root))), 1)

    def test_a_library_behind_a_gate_is_found(self):
        root = self.house({"probes/sweep.cpp": "#include <hdf5.h>\n", "recording/hdf5_file.cpp": "#include <hdf5.h>\n"})
        self.assertEqual(len(list(arrows.broken_arrows(root))), 1)

    def test_an_allowed_arrow_is_not_found(self):
        root = self.house({"probes/sweep.cpp": '#include "recording/recording.h"\n#include <vector>\n'})
        self.assertEqual(list(arrows.broken_arrows(root)), [])

    def test_an_internal_header_stays_in_its_folder(self):
        root = self.house({"relm/CMakeLists.txt": "abbe_folder(relm INTERNAL a.h b/c.h)", "relm/a.h": "",
                           "relm/face.h": '#include "relm/a.h"\n', "relm/a.cpp": '#include "relm/a.h"\n',
                           "fusion/fit.cpp": '#include "relm/b/c.h"\n'})
        self.assertEqual([line.split(":")[0] for line in arrows.open_doors(root)], ["relm/face.h", "fusion/fit.cpp"])

    def test_a_transport_known_by_name_is_found(self):
        root = self.house({
            "hal/transports.cpp": '      {"gauge", ReadGauge},\n',
            "hal/gauge/gauge_source.cpp": 'return "gauge";\n',
            "apps/record.cpp": 'if (device.transport == "gauge") return;\n',
        })
        self.assertEqual(list(arrows.named_transports(root)), ['apps/record.cpp: names the transport "gauge"'])

    def test_a_folder_without_arrows_is_found(self):
        root = self.house({"helpers/things.h": ""})
        self.assertEqual(len(list(arrows.strangers(root))), 1)


if __name__ == "__main__":
    unittest.main()
