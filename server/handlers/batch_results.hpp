#pragma once

#include <memory>
#include <set>
#include <string>

#include "api/result/result_document.hpp"
#include "server/handlers/service.hpp"
#include "server/http/response.hpp"

namespace signorini::server {

/// The results of a batch in the order in which its solves end, each once: its result, or its status document
/// if it has none. Holds one result at a time.
class BatchResults : public PartSource {
 public:
  /// The place is kept as long as the reply goes on.
  BatchResults(Service& service, std::string batch, api::Format format, const api::ResultFields& fields,
               bool summary_alone, std::shared_ptr<void> place)
      : service_(service),
        batch_(std::move(batch)),
        format_(format),
        fields_(fields),
        summary_alone_(summary_alone),
        place_(std::move(place)) {}

  bool write(const PieceSink& sink) override;
  bool is_complete() const override { return complete_; }
  std::shared_ptr<void> subscribe(std::function<void()> ready) override;

 private:
  bool write_one(Job job, const PieceSink& sink) const;

  Service& service_;
  const std::string batch_;
  const api::Format format_;
  const api::ResultFields fields_;
  const bool summary_alone_;
  const std::shared_ptr<void> place_;

  std::shared_ptr<const Watch> watch_;  ///< since before it was asked what has ended
  std::set<std::string> told_;          ///< ids
  std::int64_t latest_ = 0;             ///< BatchEnds::latest of what was told
  bool complete_ = false;
};

}  // namespace signorini::server
