#include "estimation/in_parallel.h"

#include <tbb/parallel_for.h>

#include <exception>
#include <vector>

namespace abbe::estimation {

void InParallel(std::size_t count, const std::function<void(std::size_t piece)>& work) {
  std::vector<std::exception_ptr> thrown(count);
  tbb::parallel_for(std::size_t{0}, count, [&](std::size_t piece) {
    try {
      work(piece);
    } catch (...) {
      thrown[piece] = std::current_exception();
    }
  });
  for (const std::exception_ptr& each : thrown) {
    if (each) std::rethrow_exception(each);
  }
}

}  // namespace abbe::estimation
