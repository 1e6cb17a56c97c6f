// `apps/machine_file.h`: the whole machine file, and a machine alone.
#include "apps/machine_file.h"

#include "fuzz/target.h"

namespace abbe::fuzz::machine_file {

void Read(Bytes bytes) {
  const auto document = settings::Document::Parse(TextOf(bytes), "machine.toml");
  if (document.Root().Has("devices")) {
    apps::ReadMachineFile(InputFile(bytes).path());
  } else {
    apps::ReadMachineAlone(document);
  }
}

}  // namespace abbe::fuzz::machine_file
