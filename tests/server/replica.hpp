#pragma once

#include "child_process.hpp"
#include "running_service.hpp"

namespace signorini::server {

/// How long a claim is held in the fleets of tests.
constexpr std::chrono::seconds lease_of_replicas{2};

/// A daemon of a fleet.
class Replica {
 public:
  explicit Replica(const std::string& database, std::vector<std::string> flags = {})
      : daemon_(flags_of(database, std::move(flags))), client_("127.0.0.1", daemon_.port()) {
    client_.set_read_timeout(60);
  }

  int port() const { return daemon_.port(); }
  ChildProcess& process() { return daemon_.process(); }
  httplib::Result get(const std::string& path) { return client_.Get(path); }
  httplib::Result post(const std::string& problem, const std::string& query = {}) {
    return client_.Post("/v1/solves" + query, problem, "application/json");
  }
  httplib::Result remove(const std::string& id) { return client_.Delete("/v1/solves/" + id); }
  nlohmann::json status_of(const std::string& id) {
    return nlohmann::json::parse(get("/v1/solves/" + id)->body);
  }

 private:
  static std::vector<std::string> flags_of(const std::string& database, std::vector<std::string> flags) {
    flags.insert(flags.begin(),
                 {"--database", database, "--lease-seconds", std::to_string(lease_of_replicas.count())});
    return flags;
  }

  Daemon daemon_;
  httplib::Client client_;
};

}  // namespace signorini::server
