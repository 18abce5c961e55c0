#pragma once

#include <chrono>
#include <string>

namespace signorini::server {

/// A file layer of SQLite that hands everything on to the usual one, but can be made to fail as a disk does.
/// There is one for the whole process.
class FaultyDisk {
 public:
  enum class Fault {
    none,
    full,           ///< writes fail with ENOSPC
    no_room,        ///< files cannot grow, but by the room of the reserve once that is spent
    cannot_sync,    ///< writes work, but fsync fails with EIO
    cannot_access,  ///< reads and writes fail with EIO
  };

  /// The name by which SQLite knows the layer.
  static std::string vfs();

  /// From now on; the first so many writes still work.
  static void fail(Fault fault, int writes_before = 0);

  /// How often files were synced so far.
  static int syncs();

  /// From now on a sync takes so long.
  static void slow_down(std::chrono::milliseconds sync);
};

}  // namespace signorini::server
