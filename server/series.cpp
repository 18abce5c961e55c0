#include "server/series.hpp"

#include <array>
#include <cstdio>
#include <filesystem>
#include <fstream>

#include "api/result/vtu.hpp"
#include "server/local_solve.hpp"
#include "solve.hpp"

namespace signorini::server {
namespace {

/// Keeps the operator that was made last: entries of one material follow each other.
class LastOperator : public OperatorCache {
 public:
  std::shared_ptr<const Operator> find(const std::string& key) override {
    if (key != key_) operator_.reset();
    return operator_;
  }
  void keep(const std::string& key, std::shared_ptr<const Operator> made) override {
    key_ = key;
    operator_ = std::move(made);
  }

 private:
  std::string key_;
  std::shared_ptr<const Operator> operator_;
};

template <typename Write>
void write_file(const std::string& path, const Write& write) {
  std::ofstream file(path, std::ios::binary);
  const bool written = write([&](std::string_view piece) {
    return static_cast<bool>(file.write(piece.data(), static_cast<std::streamsize>(piece.size())));
  });
  if (!written || !file.flush())
    throw BadInput{{"unwritable-file", "A file cannot be written", "Cannot write " + path + " (--series)."}};
}

std::string numbered(const char* what, std::size_t number) {
  std::array<char, 32> text;
  std::snprintf(text.data(), text.size(), "%s-%04zu.vtu", what, number);
  return text.data();
}

}  // namespace

Series::Series(std::string directory) : directory_(std::move(directory)) {
  std::error_code error;
  std::filesystem::create_directories(directory_, error);
  if (error)
    throw BadInput{{"unwritable-file", "A file cannot be written",
                    "Cannot make the directory " + directory_ + " (--series): " + error.message() + "."}};
}

void Series::add_level(const Level& level, const Solution& solution) {
  add(level.number, numbered("level", static_cast<std::size_t>(level.number)), solution);
}

void Series::add_sweep(const api::Request& request, const Solution& solution, Observer& observer) {
  add(0, numbered("entry", 0), solution);
  LastOperator last;
  SilentObserver within(observer);
  Problem varied = request.problem;
  for (std::size_t i = 0; i < request.sweep.size(); ++i) {
    const Variation& variation = request.sweep[i];
    apply(variation, request.problem, varied);
    varied.operator_key = variation.material_key + '\n' + request.problem.operator_key;
    try {
      add(static_cast<double>(i + 1), numbered("entry", i + 1),
          solve(varied, request.settings, within, last));
    } catch (const SolveError&) {
      // The result says why it has none.
    } catch (const InvalidProblem&) {
      // Likewise.
    }
  }
}

void Series::add(double time, const std::string& name, const Solution& solution) {
  write_file(directory_ + '/' + name, [&](const api::Sink& sink) { return api::write_vtu(solution, sink); });
  files_.push_back({time, name});
}

void Series::finish() const {
  write_file(directory_ + "/series.pvd", [&](const api::Sink& sink) { return api::write_pvd(files_, sink); });
}

}  // namespace signorini::server
