#pragma once

#include <filesystem>

#include <SQLiteCpp/SQLiteCpp.h>

namespace signorini::server {

/// Brings what can be read of the jobs in a damaged database file into `whole`, an empty one with the tables
/// of this version. It reads the pages of the file by itself (https://www.sqlite.org/fileformat2.html), and
/// of its log those that are as they were written, and takes the rows that are as they were written, wherever
/// they lie; pages that were given up hold none. Returns how many jobs were found. Throws std::runtime_error
/// if the files cannot be read.
std::size_t salvage(const std::filesystem::path& file, SQLite::Database& whole);

}  // namespace signorini::server
