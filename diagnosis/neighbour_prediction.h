// What the polynomial through other readings says in the place of one.
//
//   const Prediction cubic(time, row, {row - 2, row - 1, row + 1, row + 2});
//   cubic.Off(values) / cubic.Deviation();       // in standard deviations of one reading
//
// Units: those of time and values. Validity: no two rows at one time.
#pragma once

#include <cmath>
#include <cstddef>
#include <numeric>
#include <utility>
#include <vector>

namespace abbe::diagnosis {

// A reading less what the polynomial through others says in its place.
class Prediction {
 public:
  Prediction(const std::vector<double>& time, std::size_t row, std::vector<std::size_t> others)
      : row_(row), others_(std::move(others)), weights_(others_.size(), 1.0) {
    for (std::size_t k = 0; k < others_.size(); ++k) {
      for (const std::size_t other : others_) {
        if (other == others_[k]) continue;
        weights_[k] *= (time[row] - time[other]) / (time[others_[k]] - time[other]);
      }
    }
  }

  double Off(const std::vector<double>& values) const {
    double off = values[row_];
    for (std::size_t k = 0; k < others_.size(); ++k) off -= weights_[k] * values[others_[k]];
    return off;
  }
  // The scatter of Off(), in standard deviations of one reading.
  double Deviation() const {
    return std::sqrt(std::inner_product(weights_.begin(), weights_.end(), weights_.begin(), 1.0));
  }

 private:
  std::size_t row_;
  std::vector<std::size_t> others_;
  std::vector<double> weights_;
};

}  // namespace abbe::diagnosis
