#include "server/daemon.hpp"

#include <algorithm>
#include <atomic>

#include <spdlog/spdlog.h>

#include "server/cores.hpp"
#include "server/descriptors.hpp"
#include "server/exit_code.hpp"
#include "server/handlers/routes.hpp"
#include "server/http/listener.hpp"
#include "server/jobs/kept_operators.hpp"
#include "server/jobs/memory_store.hpp"
#include "server/jobs/sqlite_store.hpp"
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

/// Takes no more solves, and lets the running ones end as long as there is time and no second signal.
void drain(Scheduler& scheduler, const StopSignals& signals, std::chrono::seconds time) {
  constexpr std::chrono::milliseconds between_looks{50};
  spdlog::info("draining: running solves may end within {} s (--drain-seconds)", time.count());
  scheduler.drain();
  const auto until = std::chrono::steady_clock::now() + time;
  while (std::chrono::steady_clock::now() < until && !signals.take()) {
    if (scheduler.wait_until_idle(between_looks)) return;
  }
}

void serve(const DaemonConfig& config, const StopSignals& signals, std::atomic<bool>& failed) {
  const std::unique_ptr<JobStore> store = open_store(config);
  KeptOperators operators(config.cache_bytes);
  Metrics metrics;
  const auto solve = [&operators](const api::Request& request, Observer& observer) {
    return solve_request(request, observer, operators);
  };
  const auto ended = [&metrics](const Job& job, const Ending& ending) { metrics.ended(job, ending); };
  const auto max_memory = static_cast<double>(config.max_memory);
  Scheduler scheduler(*store, solve, config.workers, max_memory, ended);
  EventStreams events(config.max_subscribers);
  Access access = access_of(config);
  Service service{
      *store,    scheduler, events, access, {config.max_body_bytes, config.max_unknowns, max_memory},
      operators, metrics};
  const Router router = routes(service);
  Listener listener(listener_options(config), router);
  listener.start([&failed] {
    failed = true;
    StopSignals::raise();
  });
  spdlog::info("listening on {}", url(config.host, listener.port()));
  signals.wait();
  drain(scheduler, signals, std::chrono::seconds(config.drain_seconds));
  spdlog::info("stopping");
  signals.leave();
  // Solves first: clients that wait for one are answered before their connections close.
  scheduler.stop();
  events.stop();
  listener.stop();
  spdlog::info("stopped");
}

}  // namespace

int run_daemon(const DaemonConfig& config) {
  const StopSignals signals;
  share_cores(config.workers);
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
