#include "server/daemon.hpp"

#include <algorithm>
#include <atomic>
#include <condition_variable>
#include <cstdlib>
#include <thread>

#include <spdlog/spdlog.h>

#include "server/cores.hpp"
#include "server/descriptors.hpp"
#include "server/exit_code.hpp"
#include "server/handlers/routes.hpp"
#include "server/http/listener.hpp"
#include "server/idle_cores.hpp"
#include "server/jobs/kept_operators.hpp"
#include "server/jobs/memory_store.hpp"
#include "server/jobs/postgres/store.hpp"
#include "server/jobs/sqlite/store.hpp"
#include "server/metrics/metrics.hpp"
#include "server/signals.hpp"

namespace signorini::server {
namespace {

ListenerOptions listener_options(const DaemonConfig& config) {
  ListenerOptions options;
  options.host = config.host;
  options.port = config.port;
  options.max_body_bytes = config.max_body_bytes;
  return options;
}

std::string url(const std::string& host, int port) {
  const bool ipv6 = host.find(':') != std::string::npos;
  return "http://" + (ipv6 ? "[" + host + "]" : host) + ":" + std::to_string(port);
}

std::unique_ptr<JobStore> open_store(const DaemonConfig& config) {
  const StoreLimits limits{config.queue_limit, config.keep_bytes, std::chrono::seconds(config.keep_seconds)};
  if (!config.database.empty())
    return std::make_unique<postgres::Store>(config.database, limits,
                                             std::chrono::seconds(config.lease_seconds));
  if (config.data_dir == ":memory:") return std::make_unique<MemoryStore>(limits);
  return std::make_unique<SqliteStore>(config.data_dir, limits);
}

/// Throws CannotListen where everybody on the network could use the service and nobody has said that this is
/// meant.
void require_tokens_beyond_loopback(const DaemonConfig& config) {
  if (is_loopback(config.host) || !config.token_file.empty() || config.insecure) return;
  throw CannotListen("without tokens, the service listens on this machine only and not on " + config.host +
                     ": give --token-file, or --insecure if whoever can reach it may use it");
}

Access access_of(const DaemonConfig& config) {
  return {config.token_file.empty() ? BearerTokens() : BearerTokens(config.token_file),
          RequestRate(config.rate), Cors(config.cors_origins),
          is_loopback(config.host) ? KnownHosts(config.allowed_hosts) : KnownHosts()};
}

void read_tokens_again(BearerTokens& tokens) {
  try {
    tokens.reload();
    spdlog::info("SIGHUP: the tokens are read again");
  } catch (const BadTokenFile& error) {
    spdlog::error("SIGHUP: the tokens stay as they were: {}", error.what());
  }
}

using Clock = std::chrono::steady_clock;

/// By when the service ends after a signal, whatever runs: so long after it as --drain-seconds says, or a
/// second. The last quarter of that is for what must be done then.
class Deadline {
 public:
  explicit Deadline(std::chrono::seconds drain)
      : drained_(Clock::now() + drain * 3 / 4),
        left_(Clock::now() + std::max<std::chrono::milliseconds>(drain, std::chrono::seconds(1)) * 7 / 8),
        over_(Clock::now() + std::max(drain, std::chrono::seconds(1))),
        last_resort_([this](const std::stop_token& stop) { end_when_over(stop); }) {}

  Clock::time_point drained() const { return drained_; }  ///< running solves are cancelled
  Clock::time_point left() const { return left_; }        ///< those that do not hear it are left

 private:
  void end_when_over(const std::stop_token& stop) {
    std::unique_lock lock(mutex_);
    wake_.wait_until(lock, stop, over_, [] { return false; });
    if (!stop.stop_requested()) std::_Exit(exit_done);
  }

  const Clock::time_point drained_, left_, over_;
  std::mutex mutex_;
  std::condition_variable_any wake_;
  std::jthread last_resort_;
};

/// Takes no more solves, and lets the running ones end as long as there is time and no second signal.
void drain(Scheduler& scheduler, const StopSignals& signals, Clock::time_point until) {
  constexpr std::chrono::milliseconds between_looks{50};
  scheduler.drain();
  while (Clock::now() < until && !signals.take()) {
    if (scheduler.wait_until_idle(between_looks)) return;
  }
}

/// Ends the process if a solve does not hear that it is cancelled.
void end_solves(Scheduler& scheduler, Clock::time_point until) {
  scheduler.cancel_running();
  const auto time = std::chrono::duration_cast<std::chrono::milliseconds>(until - Clock::now());
  if (scheduler.wait_until_idle(std::max(time, std::chrono::milliseconds(0)))) return;
  scheduler.leave_running();
  spdlog::warn("stopped while solves ran");
  std::_Exit(exit_done);
}

void serve(const DaemonConfig& config, const StopSignals& signals, std::atomic<bool>& failed) {
  const std::unique_ptr<JobStore> store = open_store(config);
  KeptOperators operators(config.cache_bytes);
  IdleCores idle(cores(), give_way_to_answers);
  Metrics metrics;
  const auto solve = [&](const api::Request& request, Observer& observer) {
    return solve_request(request, observer, operators, idle);
  };
  const auto ended = [&metrics](const Job& job, const Ending& ending) { metrics.ended(job, ending); };
  const auto max_memory = static_cast<double>(config.max_memory);
  const int workers = config.role == Role::front ? 0 : config.workers;
  Scheduler scheduler(*store, solve, workers, max_memory, ended, config.factorization,
                      [&operators] { return operators.marks(); });
  EventStreams events(config.max_subscribers);
  Access access = access_of(config);
  Limits limits{config.max_body_bytes, config.max_unknowns, max_memory};
  limits.factorization = config.factorization;
  limits.threads = idle.threads();
  Service service{*store, scheduler, events, access, limits, operators, metrics};
  const Router router = config.role == Role::worker ? routes_of_worker(service) : routes(service);
  Listener listener(listener_options(config), router);
  listener.start([&failed] {
    failed = true;
    StopSignals::raise();
  });
  spdlog::info("listening on {}", url(config.host, listener.port()));
  signals.wait([&access] { read_tokens_again(access.tokens); });
  const Deadline deadline{std::chrono::seconds(config.drain_seconds)};
  spdlog::info("draining: the service ends within {} s (--drain-seconds)", config.drain_seconds);
  drain(scheduler, signals, deadline.drained());
  spdlog::info("stopping");
  signals.leave();
  end_solves(scheduler, deadline.left());
  // Solves first: clients that wait for one are answered before their connections close.
  scheduler.stop();
  events.stop();
  listener.stop();
  spdlog::info("stopped");
}

}  // namespace

int run_daemon(const DaemonConfig& config) {
  const StopSignals signals;
  use_one_thread_of_blas();
  raise_descriptor_limit();
  std::atomic<bool> failed = false;
  try {
    require_tokens_beyond_loopback(config);
    serve(config, signals, failed);
  } catch (const CannotListen& error) {
    spdlog::critical("{}", error.what());
    return exit_bad_input;
  } catch (const BadTokenFile& error) {
    spdlog::critical("{}", error.what());
    return exit_bad_input;
  } catch (const CannotOpenStore& error) {
    spdlog::critical("{}", error.what());
    return exit_bad_input;
  }
  if (failed) spdlog::critical("connections can no longer be accepted");
  return failed ? exit_failed : exit_done;
}

}  // namespace signorini::server
