#include "recording/hdf5_reader.h"

#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <cstdint>
#include <cstring>
#include <limits>

#include "recording/check.h"
#include "recording/hdf5_child.h"

namespace abbe::recording {
namespace {

struct OpenFile {
  Handle file;
  std::string trouble;  // why it does not open as a closed file; empty if it does
};

OpenFile Open(const std::string& name) {
  const Handle properties = FileProperties();
  OpenFile open{Handle(H5Fopen(name.c_str(), H5F_ACC_RDONLY, properties.id()), H5Fclose), ""};
  if (open.file.good()) return open;
  open.trouble = Hdf5Reason();
  // A growing file is marked until its writer closes it; it opens for SWMR readers only.
  open.file =
      Handle(H5Fopen(name.c_str(), H5F_ACC_RDONLY | H5F_ACC_SWMR_READ, properties.id()), H5Fclose);
  if (open.file.good()) return open;
  throw InputError(fmt::format("{}: this HDF5 file cannot be opened: {}; use an intact copy", name,
                               open.trouble));
}

void CheckVersion(hid_t file, const std::string& name) {
  const Handle attribute(H5Aopen(file, kVersionAttribute, H5P_DEFAULT), H5Aclose);
  const Handle type(attribute.good() ? H5Aget_type(attribute.id()) : H5I_INVALID_HID, H5Tclose);
  const Handle space(attribute.good() ? H5Aget_space(attribute.id()) : H5I_INVALID_HID, H5Sclose);
  const bool number = type.good() && space.good() && H5Tget_class(type.id()) == H5T_INTEGER &&
                      H5Sget_simple_extent_npoints(space.id()) == 1;
  std::int64_t version = 0;
  if (!number || H5Aread(attribute.id(), H5T_NATIVE_INT64, &version) < 0) {
    throw InputError(fmt::format(
        "{}: is an HDF5 file, but not a recording: it has no number `{}`; check the path", name,
        kVersionAttribute));
  }
  if (version != 1) {
    throw InputError(
        fmt::format("{}: is a recording of version {}; this abbe reads version 1, use a newer one",
                    name, version));
  }
}

// The names of the data sets in the order of their creation.
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
      : numbers_(file, name, 1, file_name) {}

  const std::string& name() const { return numbers_.name(); }
  hsize_t rows() const { return numbers_.count(); }
  void RequireStorage(const std::string& file) const { numbers_.RequireStorage(file); }

  // The number of rows before the first chunk beyond the end of a file of `size` bytes, where HDF5
  // would read zeros.
  hsize_t RowsWithin(std::uintmax_t size) const {
    const Handle layout(H5Dget_create_plist(numbers_.id()), H5Pclose);
    hsize_t chunk = 0;
    if (H5Pget_chunk(layout.id(), 1, &chunk) < 0 || chunk == 0) return rows();
    for (hsize_t first = 0; first < rows(); first += chunk) {
      haddr_t begin = HADDR_UNDEF;
      hsize_t bytes = 0;
      H5Dget_chunk_info_by_coord(numbers_.id(), &first, nullptr, &begin, &bytes);
      if (begin != HADDR_UNDEF && begin + bytes > size) return first;
    }
    return rows();
  }

  void Read(hsize_t first, hsize_t rows, const std::string& file_name,
            std::vector<double>& values) const {
    values.resize(rows);
    if (rows == 0) return;
    const Handle memory(H5Screate_simple(1, &rows, nullptr), H5Sclose);
    const Handle space(H5Dget_space(numbers_.id()), H5Sclose);
    H5Sselect_hyperslab(space.id(), H5S_SELECT_SET, &first, nullptr, &rows, nullptr);
    if (H5Dread(numbers_.id(), H5T_NATIVE_DOUBLE, memory.id(), space.id(), H5P_DEFAULT,
                values.data()) < 0) {
      throw InputError(fmt::format("{}: {}: cannot be read: {}; use an intact copy", file_name,
                                   name(), Hdf5Reason()));
    }
  }

 private:
  Hdf5Numbers numbers_;
};

std::vector<DataSet> OpenColumns(hid_t file, const std::string& file_name) {
  std::vector<DataSet> sets;
  for (const std::string& name : ColumnNames(file)) sets.emplace_back(file, name, file_name);
  return sets;
}

// Keeps the rows that all columns have: in a file that was not closed they may differ in length.
void KeepWholeRows(Recording& recording) {
  std::size_t rows = recording.rows();
  for (const Column& column : recording.columns) {
    const auto end = column.values.begin() + rows;
    const auto unwritten = std::find_if(column.values.begin(), end, [](double value) {
      return std::bit_cast<std::uint64_t>(value) == kUnwrittenBits;
    });
    rows = unwritten - column.values.begin();
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
  content.head.header = TextAttribute(content.open.file.id(), kHeaderAttribute, name);
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
  const std::string& name = content.head.name;
  if (content.open.trouble.empty()) {
    for (const DataSet& set : content.sets) {
      set.RequireStorage(name);
      if (set.rows() == content.sets.front().rows()) continue;
      throw InputError(fmt::format(
          "{}: {}: has {} rows, but {} has {}; all columns must be of one length", name, set.name(),
          set.rows(), content.sets.front().name(), content.sets.front().rows()));
    }
    return content.sets.front().rows();
  }
  hsize_t rows = std::numeric_limits<hsize_t>::max();
  const std::uintmax_t size = std::filesystem::file_size(name);
  for (const DataSet& set : content.sets) rows = std::min(rows, set.RowsWithin(size));
  return rows;
}

// The messages of the child, in this order; in each block kValues of one
// column after the other, then kBlockEnd.
enum Part : char {
  kHeader = 'H',
  kColumn = 'C',
  kUnclosed = 'U',
  kRows = 'R',
  kValues = 'V',
  kColumnEnd = 'c',
  kBlockEnd = 'B',
};

void SendHead(const Content& content, const Hdf5Sender& sender) {
  sender.Send(kHeader, content.head.header);
  for (const Column& column : content.head.columns) sender.Send(kColumn, column.name);
}

void SendAll(const std::string& name, std::size_t rows, const Hdf5Sender& sender) {
  const Content content = OpenRecording(name);
  SendHead(content, sender);
  if (!content.open.trouble.empty()) sender.Send(kUnclosed, std::string_view{});
  const hsize_t all = RowsOf(content);
  if (all > MostHdf5Numbers(name) / sizeof(double) / content.sets.size()) {
    throw InputError(fmt::format(
        "{}: states {} rows, more than a file of this size can hold; use an intact copy", name,
        all));
  }
  const std::uint64_t count = all;
  sender.Send(kRows, {reinterpret_cast<const char*>(&count), sizeof(count)});
  std::vector<double> values;
  hsize_t first = 0;
  do {
    const hsize_t wanted = std::min<hsize_t>(rows, all - first);
    for (const DataSet& set : content.sets) {
      set.Read(first, wanted, name, values);
      sender.Send(kValues, std::span<const double>(values));
      sender.Send(kColumnEnd, std::string_view{});
    }
    sender.Send(kBlockEnd, std::string_view{});
    first += wanted;
  } while (first < all);
}

// Assembles the messages of the child to blocks.
class BlockTaker {
 public:
  BlockTaker(const std::string& name, std::size_t rows, const std::function<void(Recording&)>& use)
      : rows_(rows), use_(use), check_(Places{name}) {
    block_.name = name;
  }

  // False when no more messages are needed.
  bool Take(char part, std::string_view bytes) {
    if (part == kHeader) {
      block_.header = bytes;
    } else if (part == kColumn) {
      block_.columns.push_back({std::string(bytes), {}});
    } else if (part == kUnclosed) {
      unclosed_ = true;
    } else if (part == kRows) {
      std::memcpy(&all_, bytes.data(), std::min(bytes.size(), sizeof(all_)));
      for (Column& column : block_.columns)
        column.values.reserve(std::min<std::size_t>(rows_, all_));
    } else if (part == kValues) {
      std::vector<double>& values = block_.columns.at(column_).values;
      const std::size_t before = values.size(), count = bytes.size() / sizeof(double);
      values.resize(before + count);
      std::memcpy(values.data() + before, bytes.data(), count * sizeof(double));
    } else if (part == kColumnEnd) {
      ++column_;
    } else if (part == kBlockEnd) {
      return EndBlock();
    }
    return true;
  }

 private:
  bool EndBlock() {
    const std::size_t wanted = std::min<std::size_t>(rows_, all_ - block_.first_row);
    if (unclosed_) KeepWholeRows(block_);
    const std::size_t next = block_.first_row + block_.rows();
    const bool more = block_.rows() == wanted && next < all_;
    if (!more && unclosed_) {
      block_.warnings.push_back(fmt::format(
          "{}: was not closed, because its recorder was killed or still records: the {} "
          "rows on the disk are kept",
          block_.name, next));
    }
    check_.Take(block_);
    use_(block_);
    for (Column& column : block_.columns) column.values.clear();
    block_.first_row = next;
    column_ = 0;
    return more;
  }

  std::size_t rows_;
  const std::function<void(Recording&)>& use_;
  RowCheck check_;
  Recording block_;
  std::uint64_t all_ = 0;
  std::size_t column_ = 0;
  bool unclosed_ = false;
};

}  // namespace

void ReadHdf5(const std::filesystem::path& path, std::size_t rows,
              const std::function<void(Recording& block)>& use) {
  const std::string name = path.string();
  BlockTaker taker(name, rows, use);
  ReadInChild(
      path, [&](const Hdf5Sender& sender) { SendAll(name, rows, sender); },
      [&](char part, std::string_view bytes) { return taker.Take(part, bytes); });
}

Recording ReadHdf5Head(const std::filesystem::path& path) {
  Recording head;
  head.name = path.string();
  ReadInChild(
      path, [&](const Hdf5Sender& sender) { SendHead(OpenRecording(head.name), sender); },
      [&](char part, std::string_view bytes) {
        if (part == kHeader) head.header = bytes;
        if (part == kColumn) head.columns.push_back({std::string(bytes), {}});
        return true;
      });
  return head;
}

}  // namespace abbe::recording
