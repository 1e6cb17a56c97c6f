#include "recording/hdf5_handle.h"

namespace abbe::recording {

QuietHdf5::QuietHdf5() {
  [[maybe_unused]] static const herr_t once = H5dont_atexit();
  H5Eget_auto2(H5E_DEFAULT, &function_, &data_);
  H5Eset_auto2(H5E_DEFAULT, nullptr, nullptr);
}

QuietHdf5::~QuietHdf5() { H5Eset_auto2(H5E_DEFAULT, function_, data_); }

std::string Hdf5Reason() {
  std::string reason;
  const auto keep_first = [](unsigned number, const H5E_error2_t* error, void* to) -> herr_t {
    if (number == 0 && error->desc != nullptr) *static_cast<std::string*>(to) = error->desc;
    return 0;
  };
  H5Ewalk2(H5E_DEFAULT, H5E_WALK_UPWARD, keep_first, &reason);
  return reason.empty() ? std::string("HDF5 gives no reason") : reason;
}

Handle FileProperties() {
  Handle properties(H5Pcreate(H5P_FILE_ACCESS), H5Pclose);
  H5Pset_libver_bounds(properties.id(), H5F_LIBVER_V110, H5F_LIBVER_V110);
  H5Pset_file_locking(properties.id(), false, true);
  // Metadata that another process is writing are read again, for at most some milliseconds.
  H5Pset_metadata_read_attempts(properties.id(), 20);
  return properties;
}

}  // namespace abbe::recording
