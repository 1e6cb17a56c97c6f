#include "recording/hdf5_reader.h"

#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <cstdint>
#include <limits>

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

// A text attribute, of fixed length as ours or of variable length as others write it.
std::string Text(hid_t object, const char* attribute_name, const std::string& file) {
  const Handle attribute(H5Aopen(object, attribute_name, H5P_DEFAULT), H5Aclose);
  const Handle type(attribute.good() ? H5Aget_type(attribute.id()) : H5I_INVALID_HID, H5Tclose);
  if (!type.good() || H5Tget_class(type.id()) != H5T_STRING) {
    throw InputError(fmt::format("{}: is not a recording: it has no text `{}`; check the path",
                                 file, attribute_name));
  }
  char* variable = nullptr;
  std::string fixed(H5Tget_size(type.id()), '\0');
  const bool is_variable = H5Tis_variable_str(type.id()) > 0;
  void* const to = is_variable ? static_cast<void*>(&variable) : fixed.data();
  if (H5Aread(attribute.id(), type.id(), to) < 0) {
    throw InputError(fmt::format("{}: the text `{}` cannot be read: {}; use a copy that is whole",
                                 file, attribute_name, Hdf5Reason()));
  }
  const std::string text = is_variable ? (variable == nullptr ? "" : variable) : fixed.c_str();
  if (is_variable) H5free_memory(variable);
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
      : name_(name), set_(H5Dopen2(file, name.c_str(), H5P_DEFAULT), H5Dclose) {
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

  const std::string& name() const { return name_; }
  hsize_t rows() const { return rows_; }

  // The rows before the first chunk that lies beyond the end of a file of `size` bytes. HDF5 would
  // read zeros there.
  hsize_t RowsWithin(std::uintmax_t size) const {
    const Handle layout(H5Dget_create_plist(set_.id()), H5Pclose);
    hsize_t chunk = 0;
    if (H5Pget_chunk(layout.id(), 1, &chunk) < 0 || chunk == 0) return rows_;
    for (hsize_t first = 0; first < rows_; first += chunk) {
      haddr_t begin = HADDR_UNDEF;
      hsize_t bytes = 0;
      H5Dget_chunk_info_by_coord(set_.id(), &first, nullptr, &begin, &bytes);
      if (begin != HADDR_UNDEF && begin + bytes > size) return first;
    }
    return rows_;
  }

  void Read(hsize_t first, hsize_t rows, const std::string& file_name,
            std::vector<double>& values) const {
    values.resize(rows);
    if (rows == 0) return;
    const Handle memory(H5Screate_simple(1, &rows, nullptr), H5Sclose);
    const Handle space(H5Dget_space(set_.id()), H5Sclose);
    H5Sselect_hyperslab(space.id(), H5S_SELECT_SET, &first, nullptr, &rows, nullptr);
    if (H5Dread(set_.id(), H5T_NATIVE_DOUBLE, memory.id(), space.id(), H5P_DEFAULT, values.data()) <
        0) {
      throw InputError(fmt::format("{}: {}: cannot be read: {}; use a copy that is whole",
                                   file_name, name_, Hdf5Reason()));
    }
  }

 private:
  std::string name_;
  Handle set_;
  hsize_t rows_ = 0;
};

std::vector<DataSet> OpenColumns(hid_t file, const std::string& file_name) {
  std::vector<DataSet> sets;
  for (const std::string& name : ColumnNames(file)) sets.emplace_back(file, name, file_name);
  return sets;
}

// The rows that every column of a file has that was not closed: columns grow one after the other.
void KeepWholeRows(Recording& recording) {
  std::size_t rows = recording.rows();
  for (const Column& column : recording.columns) {
    const auto end = column.values.begin() + static_cast<std::ptrdiff_t>(rows);
    const auto unwritten = std::find_if(column.values.begin(), end, [](double value) {
      return std::bit_cast<std::uint64_t>(value) == kUnwrittenBits;
    });
    rows = static_cast<std::size_t>(unwritten - column.values.begin());
  }
  for (Column& column : recording.columns) column.values.resize(rows);
}

struct Content {
  OpenFile open;
  Recording head;  // without rows
  std::vector<DataSet> sets;
};

Content OpenRecording(const std::string& name) {
  Content content{Open(name), {}, {}};
  CheckVersion(content.open.file.id(), name);
  content.head.name = name;
  content.head.header = Text(content.open.file.id(), kHeaderAttribute, name);
  content.sets = OpenColumns(content.open.file.id(), name);
  std::vector<std::string> names;
  for (const DataSet& set : content.sets) {
    names.push_back(set.name());
    content.head.columns.push_back({set.name(), {}});
  }
  CheckColumnNames(names, name);
  CheckHeader(content.head.header, names, Places{name});
  return content;
}

hsize_t RowsOf(const Content& content) {
  if (content.open.trouble.empty()) {
    for (const DataSet& set : content.sets) {
      if (set.rows() == content.sets.front().rows()) continue;
      throw InputError(
          fmt::format("{}: {}: has {} rows, but {} has {}; all columns must be of one length",
                      content.head.name, set.name(), set.rows(), content.sets.front().name(),
                      content.sets.front().rows()));
    }
    return content.sets.front().rows();
  }
  hsize_t rows = std::numeric_limits<hsize_t>::max();
  const std::uintmax_t size = std::filesystem::file_size(content.head.name);
  for (const DataSet& set : content.sets) rows = std::min(rows, set.RowsWithin(size));
  return rows;
}

}  // namespace

void ReadHdf5(const std::filesystem::path& path, std::size_t rows,
              const std::function<void(Recording& block)>& use) {
  const QuietHdf5 quiet;
  const Content content = OpenRecording(path.string());
  const hsize_t all = RowsOf(content);
  RowCheck check(Places{path.string()});
  Recording block = content.head;
  for (bool more = true; more;) {
    const hsize_t wanted = std::min<hsize_t>(rows, all - block.first_row);
    for (std::size_t i = 0; i < content.sets.size(); ++i) {
      content.sets[i].Read(block.first_row, wanted, block.name, block.columns[i].values);
    }
    if (!content.open.trouble.empty()) KeepWholeRows(block);
    const std::size_t next = block.first_row + block.rows();
    more = block.rows() == wanted && next < all;
    if (!more && !content.open.trouble.empty()) {
      block.warnings.push_back(fmt::format(
          "{}: was not closed, for its recorder was killed or still records: the {} rows "
          "that reached the disk are kept",
          block.name, next));
    }
    check.Take(block);
    use(block);
    block.first_row = next;
  }
}

Recording ReadHdf5Head(const std::filesystem::path& path) {
  const QuietHdf5 quiet;
  return OpenRecording(path.string()).head;
}

}  // namespace abbe::recording
