#include "server/http/turns.hpp"

#include <algorithm>
#include <iterator>
#include <utility>

namespace signorini::server {

void Turns::add(Task task) {
  Tasks& tasks = waiting_[task.sender];
  tasks.emplace(task.due, std::move(task));
}

std::optional<Task> Turns::take() {
  if (waiting_.empty()) return std::nullopt;
  auto sender = waiting_.upper_bound(last_);
  if (sender == waiting_.end()) sender = waiting_.begin();
  last_ = sender->first;
  Tasks& tasks = sender->second;
  std::optional<Task> next = std::move(tasks.begin()->second);
  tasks.erase(tasks.begin());
  if (tasks.empty()) waiting_.erase(sender);
  return next;
}

std::vector<Task> Turns::take_unwanted() {
  std::vector<Task> unwanted;
  for (auto& [sender, tasks] : waiting_) {
    for (auto each = tasks.begin(); each != tasks.end();) {
      Task& task = each->second;
      const bool is_unwanted = task.is_unwanted && task.is_unwanted();
      if (is_unwanted) unwanted.push_back(std::move(task));
      each = is_unwanted ? tasks.erase(each) : std::next(each);
    }
  }
  std::erase_if(waiting_, [](const auto& each) { return each.second.empty(); });
  return unwanted;
}

std::chrono::steady_clock::time_point due(std::chrono::steady_clock::time_point came, std::uint64_t bytes) {
  constexpr std::chrono::milliseconds a_kilobyte{50}, most{20'000};
  return came + std::min<std::chrono::milliseconds>(a_kilobyte * (bytes / 1024), most);
}

}  // namespace signorini::server
