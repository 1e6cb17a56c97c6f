#include "recording/hdf5_writer.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <bit>
#include <cerrno>
#include <cstdint>

#include "recording/hdf5_handle.h"
#include "recording/output_file.h"
#include "recording/row_file.h"
#include "settings/unit.h"

namespace abbe::recording {
namespace {

constexpr hsize_t kGrowingChunk = 1024;    // rows; 8 KiB, rewritten at every flush until it is full
constexpr hsize_t kFinishedChunk = 16384;  // rows
constexpr hsize_t kPage = 4096;            // bytes, a memory page of the kernel
constexpr unsigned kDeflate = 1;

// How the content begins, for the overwriting rules of WholeFile.
constexpr const char* kRecordingBegin = "\x89HDF\r\n\x1a\nabbe-recording";

constexpr const char* kNothingSaved = "nothing is saved";
constexpr const char* kRowsSaved = "the rows of the last flush are saved";

Handle Checked(hid_t id, Handle::Close close, const std::string& file,
               const char* saved = kNothingSaved) {
  if (id < 0) ThrowWriteFailure(file, saved);
  return Handle(id, close);
}

void Check(herr_t result, const std::string& file, const char* saved = kNothingSaved) {
  if (result < 0) ThrowWriteFailure(file, saved);
}

void PutText(hid_t object, const char* name, std::string_view text, const std::string& file) {
  const Handle type(H5Tcopy(H5T_C_S1), H5Tclose);
  H5Tset_size(type.id(), text.size() + 1);
  H5Tset_cset(type.id(), H5T_CSET_UTF8);
  const Handle space(H5Screate(H5S_SCALAR), H5Sclose);
  const Handle attribute = Checked(
      H5Acreate2(object, name, type.id(), space.id(), H5P_DEFAULT, H5P_DEFAULT), H5Aclose, file);
  Check(H5Awrite(attribute.id(), type.id(), std::string(text).c_str()), file);
}

// A file with the header only.
Handle CreateWithHeader(const std::string& name, const std::string& header) {
  const Handle creation(H5Pcreate(H5P_FILE_CREATE), H5Pclose);
  H5Pset_link_creation_order(creation.id(), H5P_CRT_ORDER_TRACKED | H5P_CRT_ORDER_INDEXED);
  // The kernel may stop a killed process between two pages of one write, so no metadata of the file
  // extend across pages.
  H5Pset_file_space_strategy(creation.id(), H5F_FSPACE_STRATEGY_PAGE, false, 1);
  H5Pset_file_space_page_size(creation.id(), kPage);
  const Handle access = FileProperties();
  Handle file =
      Checked(H5Fcreate(name.c_str(), H5F_ACC_TRUNC, creation.id(), access.id()), H5Fclose, name);
  const Handle space(H5Screate(H5S_SCALAR), H5Sclose);
  const Handle version = Checked(
      H5Acreate2(file.id(), kVersionAttribute, H5T_STD_I64LE, space.id(), H5P_DEFAULT, H5P_DEFAULT),
      H5Aclose, name);
  const std::int64_t one = 1;
  Check(H5Awrite(version.id(), H5T_NATIVE_INT64, &one), name);
  PutText(file.id(), kHeaderAttribute, header, name);
  return file;
}

Handle CreateColumn(hid_t file, const std::string& column, hsize_t rows, const Handle& layout,
                    const std::string& file_name) {
  const hsize_t unlimited = H5S_UNLIMITED;
  const Handle space(H5Screate_simple(1, &rows, &unlimited), H5Sclose);
  Handle set = Checked(H5Dcreate2(file, column.c_str(), H5T_IEEE_F64LE, space.id(), H5P_DEFAULT,
                                  layout.id(), H5P_DEFAULT),
                       H5Dclose, file_name);
  PutText(set.id(), kUnitAttribute, settings::UnitOf(column).name, file_name);
  return set;
}

void CreateGrowing(const std::string& name, const std::string& header,
                   const std::vector<std::string>& columns) {
  Handle file = CreateWithHeader(name, header);
  const Handle layout(H5Pcreate(H5P_DATASET_CREATE), H5Pclose);
  H5Pset_chunk(layout.id(), 1, &kGrowingChunk);
  const auto unwritten = std::bit_cast<double>(std::uint64_t{kUnwrittenBits});
  H5Pset_fill_value(layout.id(), H5T_NATIVE_DOUBLE, &unwritten);
  for (const std::string& column : columns) CreateColumn(file.id(), column, 0, layout, name);
  Check(file.CloseNow() ? 0 : -1, name);
}

// Written in place and uncompressed: rewriting a chunk at a flush neither enlarges the file nor
// damages the rows flushed before.
class Hdf5RowFile : public RowFile {
 public:
  Hdf5RowFile(const std::string& name, const std::vector<std::string>& columns) : name_(name) {
    const QuietHdf5 quiet;
    const Handle access = FileProperties();
    file_ = Checked(H5Fopen(name.c_str(), H5F_ACC_RDWR | H5F_ACC_SWMR_WRITE, access.id()), H5Fclose,
                    name);
    void* file = nullptr;
    Check(H5Fget_vfd_handle(file_.id(), H5P_DEFAULT, &file), name);
    const Handle cache(H5Pcreate(H5P_DATASET_ACCESS), H5Pclose);
    H5Pset_chunk_cache(cache.id(), 11, 2 * kGrowingChunk * sizeof(double), 1.0);
    for (const std::string& column : columns) {
      sets_.push_back(Checked(H5Dopen2(file_.id(), column.c_str(), cache.id()), H5Dclose, name));
    }
    disk_ = fcntl(*static_cast<int*>(file), F_DUPFD_CLOEXEC, 0);
    Check(disk_ < 0 ? -1 : 0, name);
  }
  ~Hdf5RowFile() override {
    Abandon();
    close(disk_);
  }

  void Write(std::span<const double> rows) override {
    const QuietHdf5 quiet;
    try {
      const hsize_t count = rows.size() / sets_.size();
      values_.resize(count);
      for (std::size_t c = 0; c < sets_.size(); ++c) {
        for (std::size_t row = 0; row < count; ++row) values_[row] = rows[row * sets_.size() + c];
        Extend(sets_[c], count);
      }
      rows_ += count;
      Check(H5Fflush(file_.id(), H5F_SCOPE_LOCAL), name_, kRowsSaved);
    } catch (const std::exception&) {
      Abandon();
      throw;
    }
  }

  // Without libhdf5, which serves one thread at a time.
  void Sync() override {
    // EINVAL: a device without synchronisation, which has the bytes already.
    if (fdatasync(disk_) != 0 && errno != EINVAL && errno != EROFS) {
      ThrowWriteFailure(name_, kRowsSaved);
    }
  }

  void Close() override {
    const QuietHdf5 quiet;
    if (!file_.good()) return;
    for (Handle& set : sets_) set.CloseNow();
    Check(file_.CloseNow() ? 0 : -1, name_, kRowsSaved);
  }

 private:
  void Extend(const Handle& set, hsize_t count) {
    const hsize_t extent = rows_ + count;
    Check(H5Dset_extent(set.id(), &extent), name_, kRowsSaved);
    const Handle memory(H5Screate_simple(1, &count, nullptr), H5Sclose);
    const Handle space = Checked(H5Dget_space(set.id()), H5Sclose, name_, kRowsSaved);
    H5Sselect_hyperslab(space.id(), H5S_SELECT_SET, &rows_, nullptr, &count, nullptr);
    Check(
        H5Dwrite(set.id(), H5T_NATIVE_DOUBLE, memory.id(), space.id(), H5P_DEFAULT, values_.data()),
        name_, kRowsSaved);
  }

  // Closing would write again to the full disk; the file stays as after the last flush.
  void Abandon() {
    for (Handle& set : sets_) set.Abandon();
    file_.Abandon();
  }

  const std::string name_;
  Handle file_;
  std::vector<Handle> sets_;
  std::vector<double> values_;
  hsize_t rows_ = 0;
  int disk_ = -1;  // second descriptor of the file, for Sync()
};

}  // namespace

std::unique_ptr<RowFile> CreateHdf5(const std::filesystem::path& path, const std::string& header,
                                    const std::vector<std::string>& columns) {
  const QuietHdf5 quiet;
  close(CreateNewFile(path));  // reserves the name
  try {
    WholeFile file(path);
    CreateGrowing(file.PartToFill(kRecordingBegin), header, columns);
    file.Finish();
    return std::make_unique<Hdf5RowFile>(path.string(), columns);
  } catch (const std::exception&) {
    std::error_code ignored;
    std::filesystem::remove(path, ignored);
    throw;
  }
}

void WriteHdf5(const Recording& recording, const std::string& header, WholeFile& whole) {
  const QuietHdf5 quiet;
  const std::string name = whole.PartToFill(kRecordingBegin);
  Handle file = CreateWithHeader(name, header);
  const Handle layout(H5Pcreate(H5P_DATASET_CREATE), H5Pclose);
  const hsize_t chunk = std::clamp<hsize_t>(recording.rows(), 1, kFinishedChunk);
  H5Pset_chunk(layout.id(), 1, &chunk);
  H5Pset_shuffle(layout.id());
  H5Pset_deflate(layout.id(), kDeflate);
  for (const Column& column : recording.columns) {
    Handle set = CreateColumn(file.id(), column.name, column.values.size(), layout, name);
    Check(
        H5Dwrite(set.id(), H5T_NATIVE_DOUBLE, H5S_ALL, H5S_ALL, H5P_DEFAULT, column.values.data()),
        name);
    Check(set.CloseNow() ? 0 : -1, name);
  }
  Check(file.CloseNow() ? 0 : -1, name);
}

}  // namespace abbe::recording
