// `fusion/calibration_file.h`, for the linkage of the demonstration machine.
#include "fusion/calibration_file.h"
#include "fuzz/target.h"
#include "settings/document.h"

namespace abbe::fuzz::calibration {

void Read(Bytes bytes) {
  static const relm::LinkageSettings linkage = relm::ReadLinkageSettings(
      settings::Document::Parse(ProjectText("machines/demo_mill.toml"), "demo_mill.toml").Root());
  fusion::ReadCalibration(InputFile(bytes).path(), linkage);
}

}  // namespace abbe::fuzz::calibration
