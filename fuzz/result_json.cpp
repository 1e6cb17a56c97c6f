// `apps/result_file.h`, results that a command reads back.
#include "apps/result_file.h"
#include "fuzz/target.h"

namespace abbe::fuzz::result_json {

void Read(Bytes bytes) { apps::ReadResult(InputFile(bytes).path()); }

}  // namespace abbe::fuzz::result_json
