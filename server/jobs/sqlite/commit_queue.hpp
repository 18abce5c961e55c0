#pragma once

#include <condition_variable>
#include <exception>
#include <functional>
#include <mutex>
#include <vector>

#include <SQLiteCpp/SQLiteCpp.h>

namespace signorini::server {

/// What a step must survive once it is done.
enum class Survives {
  process,  ///< the end of the process: it is in the hands of the system
  machine,  ///< the end of the machine too: it is on the disk, which costs a sync
};

/// Steps of several threads in one database, one transaction at a time. Those that wait while the disk syncs
/// are done together by the next transaction, so that one sync serves all of them (group commit).
class CommitQueue {
 public:
  using Step = std::function<void()>;

  explicit CommitQueue(SQLite::Database& database) : database_(database) {}

  /// Does the step within a transaction, wholly or not at all, and returns when that is committed. Throws
  /// what the step throws, and SQLite::Exception. A step may be begun more than once until it is done: where
  /// one of several fails by the database, each is done again by itself.
  void run(const Step& step, Survives survives);

  /// Does something that no transaction may surround, while there is none.
  void run_alone(const Step& step);

 private:
  struct Waiting {
    explicit Waiting(const Step& what) : step(what) {}

    const Step& step;
    std::exception_ptr error;
    bool done = false;
    std::condition_variable wake;  ///< it is done, or it is its turn to work for all
  };
  using Batch = std::vector<Waiting*>;

  void release();
  void commit(const Batch& batch, Survives survives);
  void transact(const Batch& batch, Survives survives);
  void sync_commits(Survives survives);

  SQLite::Database& database_;
  Survives synced_for_ = Survives::machine;

  std::mutex mutex_;
  bool busy_ = false;  ///< a thread works on the database
  std::condition_variable free_;
  Batch quick_, synced_;
};

}  // namespace signorini::server
