#include "server/handlers/dismiss.hpp"

#include <algorithm>

#include <spdlog/spdlog.h>

#include "server/handlers/document_response.hpp"
#include "server/http/thread_pool.hpp"
#include "server/log.hpp"

namespace signorini::server {

Dismissed dismiss(Service& service, std::span<const std::string> ids) {
  constexpr std::size_t at_once = 100;
  const ThreadPool::Waiting rest;
  Dismissed dismissed;
  for (; !ids.empty(); ids = ids.subspan(std::min(at_once, ids.size()))) {
    const auto some = ids.first(std::min(at_once, ids.size()));
    dismissed.deleted += service.store.remove_ended(some);
    for (const std::string& id : some) {
      if (!service.store.find(id)) continue;
      const Dismissal dismissal = service.scheduler.dismiss(id);
      dismissed.cancelled += dismissal == Dismissal::cancelled || dismissal == Dismissal::cancelling;
      dismissed.deleted += dismissal == Dismissal::removed;
    }
  }
  return dismissed;
}

Response dismissed_response(const Request& request, const Dismissed& dismissed) {
  spdlog::info("deleted={} cancelled={}", dismissed.deleted, dismissed.cancelled);
  return document_response(request, 200, [dismissed](api::DocumentWriter& out) {
    out.begin_object()
        .member("cancelled", dismissed.cancelled)
        .member("deleted", dismissed.deleted)
        .end_object();
  });
}

}  // namespace signorini::server
