#pragma once

#include <optional>
#include <type_traits>
#include <utility>

#include "server/jobs/sqlite/store.hpp"

namespace signorini::server {

// The two ways of an SqliteStore into its database.

/// What frees room may use the reserve then.
class DiskFull : public StoreUnavailable {
 public:
  DiskFull() : StoreUnavailable("the disk of the data directory is full") {}
};

/// Inside a handler of the error: throws StoreUnavailable if that may pass, or if the database is damaged.
[[noreturn]] void rethrow_as_unavailable(const SQLite::Exception& error);

/// Runs the step as one transaction, or as a part of one.
template <class Step>
auto SqliteStore::write(const Step& step, Survives survives) {
  std::optional<std::invoke_result_t<Step>> result;
  try {
    commits_.run([&] { result = step(); }, survives);
  } catch (const SQLite::Exception& error) {
    note_trouble(error);
    rethrow_as_unavailable(error);
  }
  return *std::move(result);
}

/// The same for a step after which there is more room.
template <class Step>
auto SqliteStore::write_what_frees(const Step& step) {
  try {
    return write(step);
  } catch (const DiskFull&) {
    const std::lock_guard lock(trouble_mutex_);
    reserve_.spend();
  }
  auto result = write(step);
  shrink();
  return result;
}

template <class Step>
auto SqliteStore::read(const Step& step) const {
  const std::lock_guard lock(reading_);
  try {
    return step();
  } catch (const SQLite::Exception& error) {
    if (is_damage(error)) note_trouble(error);
    rethrow_as_unavailable(error);
  }
}

}  // namespace signorini::server
