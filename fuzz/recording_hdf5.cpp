// `recording/hdf5_reader.h`.
#include "fuzz/target.h"
#include "recording/hdf5_reader.h"

namespace abbe::fuzz::recording_hdf5 {

void Read(Bytes bytes) {
  const InputFile file(bytes);
  recording::ReadHdf5(file.path(), 64, [&](const recording::Recording& block) {
    for (const auto& column : block.columns) {
      Require(column.values.size() == block.rows(), "columns are of one length");
    }
  });
}

}  // namespace abbe::fuzz::recording_hdf5
