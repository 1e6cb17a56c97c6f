// `study/store.h`: a store that is written again is the same store.
#include "fuzz/target.h"
#include "study/store.h"

namespace abbe::fuzz::study_store {

void Read(Bytes bytes) {
  const InputFile file(bytes);
  const study::Stored stored = study::ReadStores({file.path()});
  const std::string text = study::TextOf(stored.question, stored.rows);
  const InputFile again({reinterpret_cast<const std::uint8_t*>(text.data()), text.size()});
  const study::Stored same = study::ReadStores({again.path()});
  Require(same.question == stored.question && same.rows == stored.rows, "it is read as written");
}

}  // namespace abbe::fuzz::study_store
