#include "server/jobs/sqlite/commit_queue.hpp"

#include <utility>

namespace signorini::server {

// Whoever finds the database free works for all that wait by then, until its own step is done.
void CommitQueue::run(const Step& step, Survives survives) {
  Waiting self(step);
  std::unique_lock lock(mutex_);
  (survives == Survives::machine ? synced_ : quick_).push_back(&self);
  while (!self.done) {
    if (busy_) {
      self.wake.wait(lock);
      continue;
    }
    busy_ = true;
    // What needs no sync does not wait for one that has not begun.
    const Survives next = quick_.empty() ? Survives::machine : Survives::process;
    const Batch batch = std::exchange(next == Survives::machine ? synced_ : quick_, {});
    lock.unlock();
    commit(batch, next);
    lock.lock();
    for (Waiting* const waiting : batch) {
      waiting->done = true;
      waiting->wake.notify_one();
    }
    release();
  }
  if (self.error) std::rethrow_exception(self.error);
}

void CommitQueue::run_alone(const Step& step) {
  std::unique_lock lock(mutex_);
  free_.wait(lock, [this] { return !busy_; });
  busy_ = true;
  lock.unlock();
  std::exception_ptr error;
  try {
    step();
  } catch (...) {
    error = std::current_exception();
  }
  lock.lock();
  release();
  if (error) std::rethrow_exception(error);
}

/// The mutex must be held.
void CommitQueue::release() {
  busy_ = false;
  for (const Batch* const line : {&quick_, &synced_})
    if (!line->empty()) line->front()->wake.notify_one();
  free_.notify_one();
}

/// Every step of the batch learns its own fate.
void CommitQueue::commit(const Batch& batch, Survives survives) {
  try {
    transact(batch, survives);
    return;
  } catch (...) {
    for (Waiting* const waiting : batch) waiting->error = std::current_exception();
  }
  if (batch.size() == 1) return;
  for (Waiting* const waiting : batch) {
    waiting->error = nullptr;
    commit({waiting}, survives);
  }
}

void CommitQueue::transact(const Batch& batch, Survives survives) {
  sync_commits(survives);
  SQLite::Transaction transaction(database_, SQLite::TransactionBehavior::IMMEDIATE);
  for (Waiting* const waiting : batch) {
    database_.exec("SAVEPOINT step");
    try {
      waiting->step();
      database_.exec("RELEASE step");
    } catch (const SQLite::Exception&) {
      // May have ended the transaction of all.
      throw;
    } catch (...) {
      waiting->error = std::current_exception();
      database_.exec("ROLLBACK TO step; RELEASE step");
    }
  }
  transaction.commit();
}

void CommitQueue::sync_commits(Survives survives) {
  if (survives == synced_for_) return;
  database_.exec(survives == Survives::machine ? "PRAGMA synchronous = FULL" : "PRAGMA synchronous = NORMAL");
  synced_for_ = survives;
}

}  // namespace signorini::server
