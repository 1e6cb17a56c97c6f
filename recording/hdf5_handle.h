// HDF5 handles that close themselves, and the names in the HDF5 form of a recording.
#pragma once

#include <hdf5.h>

#include <string>
#include <utility>

namespace abbe::recording {

inline constexpr const char* kVersionAttribute = "abbe-recording";
inline constexpr const char* kHeaderAttribute = "header";
inline constexpr const char* kUnitAttribute = "unit";

// Fill value of a growing column: a NaN for rows not yet written. No row contains it, because the
// writer appends every NaN as the quiet NaN.
inline constexpr unsigned long long kUnwrittenBits = 0x7ff8'abbe'abbe'abbeULL;

// Turns off the messages of HDF5 in this thread, and its closing of files at exit: a file on a full
// disk is left unchanged.
class QuietHdf5 {
 public:
  QuietHdf5();
  ~QuietHdf5();
  QuietHdf5(const QuietHdf5&) = delete;
  QuietHdf5& operator=(const QuietHdf5&) = delete;

 private:
  H5E_auto2_t function_ = nullptr;
  void* data_ = nullptr;
};

// The first cause of the last failure, e.g. "truncated file: eof = 800, ...".
std::string Hdf5Reason();

// An HDF5 identifier that is closed on destruction.
class Handle {
 public:
  using Close = herr_t (*)(hid_t);
  Handle() = default;
  Handle(hid_t id, Close close) : id_(id), close_(close) {}
  Handle(Handle&& other) noexcept
      : id_(std::exchange(other.id_, H5I_INVALID_HID)), close_(other.close_) {}
  Handle& operator=(Handle&& other) noexcept {
    std::swap(id_, other.id_);
    std::swap(close_, other.close_);
    return *this;
  }
  ~Handle() {
    if (good()) close_(id_);
  }

  bool good() const { return id_ >= 0; }
  hid_t id() const { return id_; }
  // Closes now; whether it succeeded.
  bool CloseNow() { return close_(std::exchange(id_, H5I_INVALID_HID)) >= 0; }
  // Never closes: data in the memory of HDF5 are not written.
  void Abandon() { id_ = H5I_INVALID_HID; }

 private:
  hid_t id_ = H5I_INVALID_HID;
  Close close_ = nullptr;
};

// File access properties: the format of HDF5 1.10, which can be read while it grows, and no file
// locks, which network folders lack.
Handle FileProperties();

}  // namespace abbe::recording
