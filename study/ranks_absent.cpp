#include "study/ranks.h"

namespace abbe::study {

Ranks::Ranks() = default;
Ranks::~Ranks() = default;

void Ranks::Serve(const std::function<std::optional<std::uint64_t>()>& /*next*/,
                  const std::function<void(std::uint64_t, const std::string&)>& /*keep*/) {}

void Ranks::Ask(const std::function<std::string(std::uint64_t)>& /*work*/) {}

}  // namespace abbe::study
