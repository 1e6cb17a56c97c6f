#include "history/database.h"

#include <fmt/format.h>
#include <soci/postgresql/soci-postgresql.h>
#include <soci/soci.h>
#include <soci/sqlite3/soci-sqlite3.h>

#include <algorithm>
#include <array>
#include <filesystem>
#include <fstream>
#include <map>
#include <string_view>
#include <thread>

#include "failure/failure.h"
#include "settings/toml_text.h"

namespace abbe::history {
namespace {

using std::chrono::milliseconds;
using std::chrono::steady_clock;

// What went wrong, as far as the remedy depends on it.
enum class Trouble { kBusy, kGone, kFull, kForeign, kReadOnly, kOther };

struct StoreTrouble : std::runtime_error {
  StoreTrouble(Trouble cause, const std::string& text) : runtime_error(text), trouble(cause) {}
  Trouble trouble;
};

// The first line of a message.
std::string FirstLine(std::string text) {
  text = text.substr(0, text.find(" while "));
  std::replace(text.begin(), text.end(), '\n', ' ');
  std::replace(text.begin(), text.end(), '\t', ' ');
  return text.substr(0, text.find_last_not_of(' ') + 1);
}

Trouble TroubleOf(const soci::sqlite3_soci_error& error) {
  switch (error.result() & 0xff) {
    case SQLITE_BUSY:
    case SQLITE_LOCKED:
      return Trouble::kBusy;
    case SQLITE_FULL:
    case SQLITE_IOERR:
      return Trouble::kFull;
    case SQLITE_NOTADB:
    case SQLITE_CORRUPT:
      return Trouble::kForeign;
    case SQLITE_READONLY:
    case SQLITE_CANTOPEN:
    case SQLITE_PERM:
      return Trouble::kReadOnly;
    default:
      return Trouble::kOther;
  }
}

// Source: PostgreSQL 15, appendix A: 40001 and 40P01 a conflict of two transactions, 55P03 a lock,
// 53100 the disk, 08 and 57P the connection, 57014 a statement that was cancelled.
Trouble TroubleOf(const soci::postgresql_soci_error& error) {
  const std::string state = error.sqlstate();
  if (state == "40001" || state == "40P01" || state == "55P03") return Trouble::kBusy;
  if (state == "53100") return Trouble::kFull;
  if (state.starts_with("08") || state.starts_with("57P")) return Trouble::kGone;
  return Trouble::kOther;
}

bool IsSqlite(const std::filesystem::path& file) {
  std::array<char, 16> head{};
  std::ifstream(file, std::ios::binary).read(head.data(), head.size());
  return std::string_view(head.data(), 15) == "SQLite format 3";
}

void RefuseForeign(const std::filesystem::path& file, Database::Missing missing) {
  std::error_code error;
  if (std::filesystem::is_directory(file, error)) {
    throw InputError(fmt::format("{}: is a folder; name a file with --store", file.string()));
  }
  if (!std::filesystem::exists(file, error)) {
    if (missing == Database::Missing::kMake) return;
    throw InputError(
        fmt::format("{}: there is no history yet; begin it with abbe history add FOLDER, or name "
                    "another with --store",
                    file.string()));
  }
  if (std::filesystem::file_size(file, error) > 0 && !IsSqlite(file)) {
    throw InputError(
        fmt::format("{}: is not a history of abbe (no SQLite database), and stays as it is; name "
                    "another file with --store",
                    file.string()));
  }
}

// PostgreSQL takes no NUL and no bytes that are not UTF-8; file names may have both.
std::string Storable(const std::string& text) {
  std::string clean = text;
  std::erase(clean, '\0');
  if (settings::IsUtf8(clean)) return clean;
  for (char& each : clean) {
    if (static_cast<unsigned char>(each) >= 0x80) each = '?';
  }
  return clean;
}

// A parameter that keeps its place in memory between executions of a statement.
struct Bound {
  long long whole = 0;
  double real = 0.0;
  std::string text;
  soci::indicator state = soci::i_ok;

  void Take(const Value& value) {
    state = std::visit([](const auto& each) { return each.has_value(); }, value) ? soci::i_ok
                                                                                 : soci::i_null;
    if (state == soci::i_null) return;
    if (value.index() == 0) whole = *std::get<0>(value);
    if (value.index() == 1) real = *std::get<1>(value);
    if (value.index() == 2) text = Storable(*std::get<2>(value));
  }
};

struct Prepared {
  explicit Prepared(soci::session& session) : statement(session) {}

  void Exchange(const std::vector<Value>& values) {
    bound = std::vector<Bound>(values.size());
    for (std::size_t i = 0; i < values.size(); ++i) {
      bound[i].Take(values[i]);
      if (values[i].index() == 0) statement.exchange(soci::use(bound[i].whole, bound[i].state));
      if (values[i].index() == 1) statement.exchange(soci::use(bound[i].real, bound[i].state));
      if (values[i].index() == 2) statement.exchange(soci::use(bound[i].text, bound[i].state));
    }
  }

  soci::statement statement;
  std::vector<Bound> bound;
};

Value ValueAt(const soci::row& row, std::size_t column) {
  const bool is_null = row.get_indicator(column) == soci::i_null;
  switch (row.get_properties(column).get_data_type()) {
    case soci::dt_double:
      return is_null ? Real({}) : Real(row.get<double>(column));
    case soci::dt_integer:
      return is_null ? Whole({}) : Whole(row.get<int>(column));
    case soci::dt_long_long:
      return is_null ? Whole({}) : Whole(row.get<long long>(column));
    case soci::dt_unsigned_long_long:
      return is_null ? Whole({})
                     : Whole(static_cast<long long>(row.get<unsigned long long>(column)));
    default:
      return is_null ? Text({}) : Text(row.get<std::string>(column));
  }
}

}  // namespace

class Database::Connection {
 public:
  Connection(const StoreAddress& where, Missing missing) : address_(where) {
    if (address_.IsFile()) {
      RefuseForeign(address_.file, missing);
      std::error_code error;
      if (missing == Missing::kMake && address_.file.has_parent_path()) {
        std::filesystem::create_directories(address_.file.parent_path(), error);
      }
    }
    constexpr std::chrono::seconds kFirst{3};  // a wrong address shows at once
    Patiently(steady_clock::now() + (address_.IsFile() ? address_.patience : kFirst),
              [this] { Open(); });
  }

  void InTransaction(Intent intent, const std::function<void()>& work) {
    Patiently(steady_clock::now() + address_.patience, [&] {
      if (!session_) Open();
      Guarded([&] { Begin(intent); });
      try {
        work();
        Guarded([&] { *session_ << "commit"; });
      } catch (...) {
        Rollback();
        throw;
      }
    });
  }

  void Run(const std::string& text, const std::vector<Value>& values) {
    Guarded([&] {
      auto& prepared = prepared_[text];
      if (!prepared) {
        prepared = std::make_unique<Prepared>(*session_);
        prepared->statement.alloc();
        prepared->statement.prepare(text);
        prepared->Exchange(values);
        prepared->statement.define_and_bind();
      } else {
        for (std::size_t i = 0; i < values.size(); ++i) prepared->bound[i].Take(values[i]);
      }
      prepared->statement.execute(true);
    });
  }

  std::vector<Row> Rows(const std::string& text, const std::vector<Value>& values) {
    std::vector<Row> rows;
    Guarded([&] {
      Prepared prepared(*session_);
      soci::row row;
      prepared.statement.alloc();
      prepared.statement.prepare(text);
      prepared.Exchange(values);
      prepared.statement.exchange(soci::into(row));
      prepared.statement.define_and_bind();
      for (bool more = prepared.statement.execute(true); more; more = prepared.statement.fetch()) {
        std::vector<Value> cells;
        cells.reserve(row.size());
        for (std::size_t i = 0; i < row.size(); ++i) cells.push_back(ValueAt(row, i));
        rows.emplace_back(std::move(cells));
      }
    });
    return rows;
  }

  void RunAlone(const std::string& text, const std::vector<Value>& values) {
    Patiently(steady_clock::now() + address_.patience, [&] {
      if (!session_) Open();
      Run(text, values);
      prepared_.clear();
    });
  }

  const StoreAddress& address() const { return address_; }

 private:
  void Open() {
    session_.reset();
    Guarded([this] {
      if (address_.IsFile()) {
        // SOCI reads "db=... timeout=..."; a quote would end the name.
        if (address_.file.string().find('"') != std::string::npos) {
          throw InputError(fmt::format("{}: a store cannot have \" in its name; choose another",
                                       address_.file.string()));
        }
        session_ = std::make_unique<soci::session>(
            soci::sqlite3,
            fmt::format("db=\"{}\" timeout={}", address_.file.string(), address_.patience.count()));
        for (const char* const pragma : {"pragma journal_mode = wal", "pragma synchronous = full",
                                         "pragma foreign_keys = on"}) {
          Rows(pragma, {});
        }
      } else {
        session_ = std::make_unique<soci::session>(soci::postgresql, address_.server);
        // libpq prints what a server says at its end; the failure that follows says it too.
        const auto* backend =
            static_cast<soci::postgresql_session_backend*>(session_->get_backend());
        PQsetNoticeProcessor(
            backend->conn_, [](void*, const char*) {}, nullptr);
        *session_ << "set client_min_messages to warning";
        *session_ << "create schema if not exists abbe";
        *session_ << "set search_path to abbe";
      }
    });
  }

  void Begin(Intent intent) {
    if (address_.IsFile()) {
      *session_ << (intent == Intent::kWrite ? "begin immediate" : "begin");
      return;
    }
    *session_ << "begin";
    // One writer at a time: what it reads before it writes then stays true until it commits.
    constexpr long long kWriters = 4608230002;
    if (intent == Intent::kWrite) {
      *session_ << fmt::format("select pg_advisory_xact_lock({})", kWriters);
    }
  }

  void Rollback() {
    try {
      if (session_) *session_ << "rollback";
      prepared_.clear();
    } catch (const std::exception&) {
      prepared_.clear();
      session_.reset();  // the server undoes what lost its connection
    }
  }

  // Calls `use` and turns SOCI's failures into StoreTrouble.
  void Guarded(const std::function<void()>& use) {
    try {
      use();
    } catch (const soci::sqlite3_soci_error& error) {
      throw StoreTrouble(TroubleOf(error), FirstLine(error.get_error_message()));
    } catch (const soci::postgresql_soci_error& error) {
      const bool gone = !session_ || !session_->is_connected();
      throw StoreTrouble(gone ? Trouble::kGone : TroubleOf(error),
                         FirstLine(error.get_error_message()));
    } catch (const soci::soci_error& error) {
      const bool gone = !address_.IsFile() && (!session_ || !session_->is_connected());
      throw StoreTrouble(gone                ? Trouble::kGone
                         : address_.IsFile() ? Trouble::kReadOnly
                                             : Trouble::kOther,
                         FirstLine(error.get_error_message()));
    }
  }

  // Repeats `work` while another writer or a lost server is in the way.
  void Patiently(steady_clock::time_point until, const std::function<void()>& work) {
    for (milliseconds wait(50);; wait = std::min(2 * wait, milliseconds(1000))) {
      try {
        return work();
      } catch (const StoreTrouble& trouble) {
        const bool passes = trouble.trouble == Trouble::kBusy || trouble.trouble == Trouble::kGone;
        if (!passes || steady_clock::now() + wait > until) Refuse(trouble);
        if (trouble.trouble == Trouble::kGone) {
          prepared_.clear();
          session_.reset();
        }
      }
      std::this_thread::sleep_for(wait);
    }
  }

  [[noreturn]] void Refuse(const StoreTrouble& trouble) const {
    const std::string where = address_.Shown(), why = trouble.what();
    switch (trouble.trouble) {
      case Trouble::kBusy:
        throw DeviceError(fmt::format(
            "{}: another program holds the store locked ({}); nothing of this step was stored; try "
            "again when it has finished",
            where, why));
      case Trouble::kGone:
        throw DeviceError(
            fmt::format("{}: the server does not answer ({}); nothing of this step was stored; "
                        "check address and server, and run it again",
                        where, why));
      case Trouble::kFull:
        throw DeviceError(
            fmt::format("{}: cannot be written, the disk is full or fails ({}); nothing of this "
                        "step was stored; make room and run it again",
                        where, why));
      case Trouble::kForeign:
        throw InputError(
            fmt::format("{}: is not a history of abbe, or is damaged ({}); name another with "
                        "--store, or restore a copy",
                        where, why));
      case Trouble::kReadOnly:
        throw InputError(fmt::format(
            "{}: cannot be opened for writing ({}); check folder and permissions, or name another "
            "with --store",
            where, why));
      case Trouble::kOther:
        break;
    }
    throw DeviceError(fmt::format("{}: the store refused a step: {}", where, why));
  }

  StoreAddress address_;
  std::unique_ptr<soci::session> session_;
  std::map<std::string, std::unique_ptr<Prepared>> prepared_;
};

Database::Database(const StoreAddress& address, Missing missing)
    : connection_(std::make_unique<Connection>(address, missing)) {}
Database::~Database() = default;

void Database::InTransaction(Intent intent, const std::function<void()>& work) {
  connection_->InTransaction(intent, work);
}
void Database::Run(const std::string& statement, const std::vector<Value>& values) {
  connection_->Run(statement, values);
}
std::vector<Row> Database::Rows(const std::string& statement, const std::vector<Value>& values) {
  return connection_->Rows(statement, values);
}
void Database::RunAlone(const std::string& statement, const std::vector<Value>& values) {
  connection_->RunAlone(statement, values);
}
bool Database::IsFile() const { return connection_->address().IsFile(); }
const StoreAddress& Database::address() const { return connection_->address(); }

}  // namespace abbe::history
