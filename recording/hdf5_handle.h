// What of HDF5 the reader and the writer share: handles that close themselves, and the form's
// names.
#pragma once

#include <hdf5.h>

#include <string>
#include <utility>

namespace abbe::recording {

inline constexpr const char* kVersionAttribute = "abbe-recording";
inline constexpr const char* kHeaderAttribute = "header";
inline constexpr const char* kUnitAttribute = "unit";

// A growing column is filled with this NaN where no row was written yet; no row can hold it,
// because the writer appends every NaN as the plain one.
inline constexpr unsigned long long kUnwrittenBits = 0x7ff8'abbe'abbe'abbeULL;

// Keeps HDF5 from printing its own messages in this thread, and from closing files behind our back
// at exit: a file on a full disk is left as it is.
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
  // Closes now; whether that went well.
  bool CloseNow() { return close_(std::exchange(id_, H5I_INVALID_HID)) >= 0; }
  // Never closes: what HDF5 still holds is not written.
  void Abandon() { id_ = H5I_INVALID_HID; }

 private:
  hid_t id_ = H5I_INVALID_HID;
  Close close_ = nullptr;
};

// Properties to open or create a file with: the form of HDF5 1.10, which can be read while it
// grows, and no locks, which network folders lack.
Handle FileProperties();

}  // namespace abbe::recording
