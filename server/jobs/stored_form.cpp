#include "server/jobs/stored_form.hpp"

#include <algorithm>
#include <sstream>
#include <stdexcept>

#include <zstd.h>
#include <cereal/archives/portable_binary.hpp>

#include "server/jobs/stored_members.hpp"

namespace signorini::server {
namespace {

/// The fastest levels of zstd lose little on doubles, of which the bytes mostly consist.
constexpr int compression_level = 1;

std::size_t checked(std::size_t code) {
  if (ZSTD_isError(code)) throw std::runtime_error(std::string("zstd: ") + ZSTD_getErrorName(code));
  return code;
}

std::string compress(const std::string& plain) {
  const std::unique_ptr<ZSTD_CCtx, decltype(&ZSTD_freeCCtx)> context(ZSTD_createCCtx(), ZSTD_freeCCtx);
  checked(ZSTD_CCtx_setParameter(context.get(), ZSTD_c_compressionLevel, compression_level));
  checked(ZSTD_CCtx_setParameter(context.get(), ZSTD_c_checksumFlag, 1));
  std::string packed(ZSTD_compressBound(plain.size()), '\0');
  packed.resize(
      checked(ZSTD_compress2(context.get(), packed.data(), packed.size(), plain.data(), plain.size())));
  return packed;
}

std::runtime_error damaged() {
  return std::runtime_error("stored bytes are damaged");
}

/// The size that damaged bytes claim may be any: room is made as what they hold comes to need it, which
/// doubles hardly ever do.
std::string decompress(const std::string& packed) {
  const auto size = ZSTD_getFrameContentSize(packed.data(), packed.size());
  if (size == ZSTD_CONTENTSIZE_ERROR || size == ZSTD_CONTENTSIZE_UNKNOWN) throw damaged();
  const std::unique_ptr<ZSTD_DCtx, decltype(&ZSTD_freeDCtx)> context(ZSTD_createDCtx(), ZSTD_freeDCtx);
  std::string plain(std::min<unsigned long long>(size, 64 * packed.size()), '\0');
  ZSTD_inBuffer in{packed.data(), packed.size(), 0};
  std::size_t done = 0, left = 1;
  while (left > 0) {
    if (done == plain.size() && done < size) plain.resize(std::min<unsigned long long>(size, 2 * done));
    ZSTD_outBuffer out{plain.data(), plain.size(), done};
    const std::size_t read_before = in.pos;
    left = checked(ZSTD_decompressStream(context.get(), &out, &in));
    const bool stuck = in.pos == read_before && out.pos == done;
    done = out.pos;
    if (stuck && (in.pos == in.size || done == size)) throw damaged();
  }
  if (done != size) throw damaged();
  return plain;
}

template <class... Values>
std::string serialized(const Values&... values) {
  std::ostringstream stream;
  cereal::PortableBinaryOutputArchive archive(stream);
  archive(values...);
  return std::move(stream).str();
}

}  // namespace

std::string pack_text(const std::string& text) {
  return compress(text);
}

std::string unpack_text(const std::string& bytes) {
  return decompress(bytes);
}

std::string pack_verdict(const Verdict& verdict) {
  return serialized(verdict);
}

Verdict unpack_verdict(const std::string& bytes) {
  std::istringstream stream(bytes);
  cereal::PortableBinaryInputArchive archive(stream);
  Verdict verdict;
  archive(verdict);
  return verdict;
}

std::string pack_findings(const Ending& ending) {
  if (ending.solution) return compress(serialized(true, *ending.solution));
  return compress(serialized(false, ending.history ? *ending.history : std::vector<Iteration>()));
}

void unpack_findings(const std::string& bytes, JobResult& result) {
  std::istringstream stream(decompress(bytes));
  cereal::PortableBinaryInputArchive archive(stream);
  bool solved = false;
  archive(solved);
  if (solved) {
    const auto solution = std::make_shared<Solution>();
    archive(*solution);
    result.solution = solution;
    result.history = {solution, &solution->history};
  } else {
    const auto history = std::make_shared<std::vector<Iteration>>();
    archive(*history);
    result.history = history;
  }
}

}  // namespace signorini::server
