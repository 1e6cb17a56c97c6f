#include "hal/modbus/modbus_server.h"

namespace abbe::hal {

void RegisterImage::Set(int unit, RegisterTable table, int address,
                        std::initializer_list<std::uint16_t> words) {
  Set(unit, table, address, std::span(words.begin(), words.size()));
}

void RegisterImage::Set(int unit, RegisterTable table, int address,
                        std::span<const std::uint16_t> words) {
  const std::lock_guard lock(mutex_);
  for (const std::uint16_t word : words) words_[{unit, table, address++}] = word;
}

std::uint16_t RegisterImage::Get(int unit, RegisterTable table, int address) const {
  const std::lock_guard lock(mutex_);
  const auto found = words_.find({unit, table, address});
  return found == words_.end() ? 0 : found->second;
}

bool RegisterImage::HasUnit(int unit) const {
  const auto first = words_.lower_bound({unit, RegisterTable::kHolding, 0});
  return first != words_.end() && std::get<0>(first->first) == unit;
}

Answer RegisterImage::Read(int unit, RegisterTable table, int address,
                           std::span<std::uint16_t> words) {
  const std::lock_guard lock(mutex_);
  if (!HasUnit(unit)) return Answer::kNoSuchUnit;
  for (std::uint16_t& word : words) {
    const auto found = words_.find({unit, table, address++});
    if (found == words_.end()) return Answer::kIllegalAddress;
    word = found->second;
  }
  return Answer::kOk;
}

Answer RegisterImage::Write(int unit, int address, std::span<const std::uint16_t> words) {
  const std::lock_guard lock(mutex_);
  if (!HasUnit(unit)) return Answer::kNoSuchUnit;
  for (std::size_t i = 0; i < words.size(); ++i) {
    if (!words_.contains({unit, RegisterTable::kHolding, address + static_cast<int>(i)})) {
      return Answer::kIllegalAddress;
    }
  }
  for (const std::uint16_t word : words) words_[{unit, RegisterTable::kHolding, address++}] = word;
  return Answer::kOk;
}

}  // namespace abbe::hal
