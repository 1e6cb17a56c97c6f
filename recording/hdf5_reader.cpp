#include "recording/hdf5_reader.h"

#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <cstdint>

#include "recording/check.h"
#include "recording/hdf5_handle.h"

namespace abbe::recording {
namespace {

struct OpenFile {
  Handle file;
  std::string trouble;  // why it does not open as a file that was closed; empty when it does
};

OpenFile Open(const std::string& name) {
  const Handle properties = FileProperties();
  OpenFile open{Handle(H5Fopen(name.c_str(), H5F_ACC_RDONLY, properties.id()), H5Fclose), ""};
  if (open.file.good()) return open;
  open.trouble = Hdf5Reason();
  // A file that grows is marked until its writer closes it; a reader that says it knows may enter.
  open.file =
      Handle(H5Fopen(name.c_str(), H5F_ACC_RDONLY | H5F_ACC_SWMR_READ, properties.id()), H5Fclose);
  if (open.file.good()) return open;
  throw InputError(fmt::format("{}: this HDF5 file cannot be opened: {}; use a copy that is whole",
                               name, open.trouble));
}

// A text attribute of a file or a data set.
std::string Text(hid_t object, const char* attribute_name, const std::string& file) {
  const Handle attribute(H5Aopen(object, attribute_name, H5P_DEFAULT), H5Aclose);
  const Handle type(attribute.good() ? H5Aget_type(attribute.id()) : H5I_INVALID_HID, H5Tclose);
  if (!type.good() || H5Tget_class(type.id()) != H5T_STRING || H5Tis_variable_str(type.id()) != 0) {
    throw InputError(
        fmt::format("{}: is not a recording: it has no text `{}` of fixed length; check the path",
                    file, attribute_name));
  }
  std::string text(H5Tget_size(type.id()), '\0');
  if (H5Aread(attribute.id(), type.id(), text.data()) < 0) {
    throw InputError(fmt::format("{}: the text `{}` cannot be read: {}; use a copy that is whole",
                                 file, attribute_name, Hdf5Reason()));
  }
  text.resize(std::min(text.find('\0'), text.size()));
  return text;
}

void CheckVersion(hid_t file, const std::string& name) {
  const Handle attribute(H5Aopen(file, kVersionAttribute, H5P_DEFAULT), H5Aclose);
  std::int64_t version = 0;
  if (!attribute.good() || H5Aread(attribute.id(), H5T_NATIVE_INT64, &version) < 0) {
    throw InputError(fmt::format(
        "{}: is an HDF5 file, but not a recording: it has no attribute `{}`; check the path", name,
        kVersionAttribute));
  }
  if (version != 1) {
    throw InputError(
        fmt::format("{}: is a recording of version {}; this abbe reads version 1, use a newer one",
                    name, version));
  }
}

// The names of the data sets in the order in which they were made.
std::vector<std::string> ColumnNames(hid_t file) {
  std::vector<std::string> names;
  const auto add = [](hid_t, const char* name, const H5L_info_t*, void* to) -> herr_t {
    static_cast<std::vector<std::string>*>(to)->emplace_back(name);
    return 0;
  };
  if (H5Literate(file, H5_INDEX_CRT_ORDER, H5_ITER_INC, nullptr, add, &names) < 0) {
    names.clear();
    H5Literate(file, H5_INDEX_NAME, H5_ITER_INC, nullptr, add, &names);
  }
  return names;
}

// One column of numbers in the file.
class DataSet {
 public:
  DataSet(hid_t file, const std::string& name, const std::string& file_name)
      : set_(H5Dopen2(file, name.c_str(), H5P_DEFAULT), H5Dclose) {
    const Handle space(set_.good() ? H5Dget_space(set_.id()) : H5I_INVALID_HID, H5Sclose);
    const Handle type(set_.good() ? H5Dget_type(set_.id()) : H5I_INVALID_HID, H5Tclose);
    const bool number = type.good() && (H5Tget_class(type.id()) == H5T_FLOAT ||
                                        H5Tget_class(type.id()) == H5T_INTEGER);
    if (!space.good() || !number || H5Sget_simple_extent_ndims(space.id()) != 1) {
      throw InputError(
          fmt::format("{}: {}: is not a column (one row of numbers); remove it from the file",
                      file_name, name));
    }
    H5Sget_simple_extent_dims(space.id(), &rows_, nullptr);
  }

  hsize_t rows() const { return rows_; }

  // Reads the first `rows` values; how many could be read, which is fewer when the file is cut.
  hsize_t Read(hsize_t rows, std::vector<double>& values) const {
    values.resize(rows);
    if (rows == 0 || ReadPart(0, rows, values.data())) return rows;
    constexpr hsize_t kPart = 4096;
    for (hsize_t first = 0; first < rows; first += kPart) {
      if (!ReadPart(first, std::min(kPart, rows - first), values.data() + first)) return first;
    }
    return rows;
  }

 private:
  bool ReadPart(hsize_t first, hsize_t count, double* to) const {
    const Handle memory(H5Screate_simple(1, &count, nullptr), H5Sclose);
    const Handle space(H5Dget_space(set_.id()), H5Sclose);
    H5Sselect_hyperslab(space.id(), H5S_SELECT_SET, &first, nullptr, &count, nullptr);
    return H5Dread(set_.id(), H5T_NATIVE_DOUBLE, memory.id(), space.id(), H5P_DEFAULT, to) >= 0;
  }

  Handle set_;
  hsize_t rows_ = 0;
};

void ReadColumns(hid_t file, Recording& recording, bool whole) {
  std::vector<DataSet> sets;
  for (const std::string& name : ColumnNames(file)) {
    sets.emplace_back(file, name, recording.name);
    recording.columns.push_back({name, {}});
  }
  // Columns grow one after the other: a row is whole when the shortest has it.
  hsize_t rows = sets.empty() ? 0 : sets.front().rows();
  for (const DataSet& set : sets) rows = std::min(rows, set.rows());
  const hsize_t extent = rows;
  for (std::size_t c = 0; c < sets.size(); ++c) {
    rows = std::min(rows, sets[c].Read(whole ? sets[c].rows() : rows, recording.columns[c].values));
  }
  if (whole && rows < extent) {
    throw InputError(fmt::format("{}: row {}: cannot be read: {}; use a copy that is whole",
                                 recording.name, rows + 1, Hdf5Reason()));
  }
  if (whole) return;
  const auto unwritten = [](double value) {
    return std::bit_cast<std::uint64_t>(value) == kUnwrittenBits;
  };
  for (const Column& column : recording.columns) {
    const auto end = column.values.begin() + static_cast<std::ptrdiff_t>(rows);
    rows = static_cast<hsize_t>(std::find_if(column.values.begin(), end, unwritten) -
                                column.values.begin());
  }
  for (Column& column : recording.columns) column.values.resize(rows);
}

}  // namespace

Recording ReadHdf5(const std::filesystem::path& path) {
  const QuietHdf5 quiet;
  Recording recording;
  recording.name = path.string();
  const OpenFile open = Open(recording.name);
  CheckVersion(open.file.id(), recording.name);
  recording.header = Text(open.file.id(), kHeaderAttribute, recording.name);
  ReadColumns(open.file.id(), recording, open.trouble.empty());
  if (!open.trouble.empty()) {
    recording.warnings.push_back(
        fmt::format("{}: was not closed, or was cut ({}): the {} rows that are whole are kept",
                    recording.name, open.trouble, recording.rows()));
  }
  Check(recording, Places{recording.name});
  return recording;
}

}  // namespace abbe::recording
