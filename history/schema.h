// The tables of a store, by numbered steps from one version to the next.
//
//   Database database(address, Database::Missing::kMake);
//   const std::vector<std::string> notes = BringUpToDate(database, Migrations());
//
// An empty store gets all steps; an older one the steps that it lacks, after a copy (a file beside
// it, or a schema abbe_version_N on a server), which the notes name. All steps are one
// transaction: a kill in between leaves the older version. InputError for a store of a newer
// version, and for a database that holds other tables and no history.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "history/database.h"

namespace abbe::history {

// The statements of one step. In them {id}, {whole}, {real} and {clustered} stand for what SQLite
// and PostgreSQL call differently.
using Migration = std::vector<std::string>;

// In their order: the first makes version 1. A step that was released is never changed.
std::span<const Migration> Migrations();

std::vector<std::string> BringUpToDate(Database& database, std::span<const Migration> migrations);

}  // namespace abbe::history
