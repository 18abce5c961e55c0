#pragma once

#include <map>
#include <mutex>
#include <optional>
#include <stdexcept>
#include <string>

namespace signorini::server {

/// The memory that solves may take is spoken for; the text says by what.
class MemoryFull : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// What the solves that may run at the same time are predicted to take: the largest ones of those that were
/// admitted and have not ended, as many as there are workers.
class MemoryBudget {
 public:
  MemoryBudget(double max_bytes, std::size_t workers) : max_bytes_(max_bytes), workers_(workers) {}

  /// Throws MemoryFull if the job could come to run with others that leave too little, or too little of the
  /// `share` of its owner, if there is one.
  void admit(const std::string& job, double bytes, const std::string& owner = {},
             const std::optional<double>& share = std::nullopt);

  /// Throws MemoryFull if a job takes more by itself than there is for anybody, or for its owner.
  void require_alone(double bytes, const std::string& owner, const std::optional<double>& share) const;

  /// Counts a job that was admitted elsewhere.
  void add(const std::string& job, double bytes, const std::string& owner = {});

  /// What one job more may take that begins at once.
  double left() const;

  /// What one job may take that runs alone.
  double most() const { return max_bytes_; }

  /// What the job may take, with what the largest of the others leave; more than it was predicted to.
  double left_for(const std::string& job) const;

  bool knows(const std::string& job) const;
  void release(const std::string& job);

 private:
  struct Taken {
    double bytes = 0;
    std::string owner;
  };

  double largest(const std::optional<std::string>& owner = std::nullopt) const;

  const double max_bytes_;
  const std::size_t workers_;
  mutable std::mutex mutex_;
  std::map<std::string, Taken> taken_;  ///< by job
};

}  // namespace signorini::server
