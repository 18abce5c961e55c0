#include "server/jobs/stored_form.hpp"

#include <algorithm>
#include <array>
#include <sstream>
#include <stdexcept>
#include <streambuf>

#include <zstd.h>
#include <cereal/archives/portable_binary.hpp>
#include <nlohmann/json.hpp>

#include "server/jobs/stored_members.hpp"

namespace signorini::server {
namespace {

/// The fastest levels of zstd lose little on doubles, of which the bytes mostly consist.
constexpr int compression_level = 1;

std::size_t checked(std::size_t code) {
  if (ZSTD_isError(code)) throw std::runtime_error(std::string("zstd: ") + ZSTD_getErrorName(code));
  return code;
}

/// Counts what is written to it.
class ByteCount : public std::streambuf {
 public:
  std::size_t size() const { return size_; }

 protected:
  std::streamsize xsputn(const char*, std::streamsize count) override {
    size_ += static_cast<std::size_t>(count);
    return count;
  }

 private:
  std::size_t size_ = 0;
};

/// Compresses what is written to it, whose size has to be known: the packed bytes say it.
class PackedBytes : public std::streambuf {
 public:
  explicit PackedBytes(std::size_t size) : context_(ZSTD_createCCtx(), ZSTD_freeCCtx) {
    checked(ZSTD_CCtx_setParameter(context_.get(), ZSTD_c_compressionLevel, compression_level));
    checked(ZSTD_CCtx_setParameter(context_.get(), ZSTD_c_checksumFlag, 1));
    checked(ZSTD_CCtx_setPledgedSrcSize(context_.get(), size));
    // What is not filled of it takes no memory.
    packed_.reserve(ZSTD_compressBound(size));
    setp(plain_.data(), plain_.data() + plain_.size());
  }

  /// Once all is written.
  std::string finish() {
    compress(ZSTD_e_end);
    return std::move(packed_);
  }

 protected:
  int_type overflow(int_type byte) override {
    compress(ZSTD_e_continue);
    setp(plain_.data(), plain_.data() + plain_.size());
    return sputc(traits_type::to_char_type(byte));
  }

 private:
  void compress(ZSTD_EndDirective directive) {
    ZSTD_inBuffer in{pbase(), static_cast<std::size_t>(pptr() - pbase()), 0};
    for (bool is_done = false; !is_done;) {
      ZSTD_outBuffer out{some_.data(), some_.size(), 0};
      const std::size_t left = checked(ZSTD_compressStream2(context_.get(), &out, &in, directive));
      packed_.append(some_.data(), out.pos);
      is_done = directive == ZSTD_e_end ? left == 0 : in.pos == in.size;
    }
  }

  const std::unique_ptr<ZSTD_CCtx, decltype(&ZSTD_freeCCtx)> context_;
  std::array<char, 128 * 1024> plain_, some_;
  std::string packed_;
};

std::runtime_error damaged() {
  return std::runtime_error("stored bytes are damaged");
}

/// What packed bytes hold, while they are read. Their checksum is read last, so that there is input as long
/// as there is output.
class PlainBytes : public std::streambuf {
 public:
  explicit PlainBytes(const ReadBytes& packed)
      : packed_(packed), context_(ZSTD_createDCtx(), ZSTD_freeDCtx), size_(unpacked_size(packed)) {}

  /// Reads over all of them. Throws if they are damaged.
  void check() {
    while (underflow() != traits_type::eof()) setg(nullptr, nullptr, nullptr);
  }

 protected:
  int_type underflow() override {
    while (!ended_) {
      if (in_.pos == in_.size) fetch();
      ZSTD_outBuffer out{plain_.data(), plain_.size(), 0};
      const std::size_t left = checked(ZSTD_decompressStream(context_.get(), &out, &in_));
      done_ += out.pos;
      ended_ = left == 0;
      if (ended_ && (done_ != size_ || in_.pos != in_.size || fetched_more())) throw damaged();
      if (out.pos == 0) continue;
      setg(plain_.data(), plain_.data(), plain_.data() + out.pos);
      return traits_type::to_int_type(plain_[0]);
    }
    return traits_type::eof();
  }

 private:
  bool fetched_more() {
    in_ = {read_.data(), packed_(offset_, read_), 0};
    offset_ += in_.size;
    return in_.size > 0;
  }
  void fetch() {
    if (!fetched_more()) throw damaged();
  }

  const ReadBytes& packed_;
  const std::unique_ptr<ZSTD_DCtx, decltype(&ZSTD_freeDCtx)> context_;
  const std::size_t size_;
  std::array<char, 128 * 1024> read_, plain_;
  std::size_t offset_ = 0;  ///< in the packed bytes
  std::size_t done_ = 0;
  ZSTD_inBuffer in_{read_.data(), 0, 0};
  bool ended_ = false;
};

/// The size that damaged bytes claim may be any: room is made for what they hold.
std::string decompress(const std::string& packed) {
  const ReadBytes read = [&packed](std::size_t offset, std::span<char> room) {
    return packed.copy(room.data(), room.size(), offset);
  };
  PlainBytes bytes(read);
  std::string plain;
  std::array<char, 16 * 1024> some;
  while (const auto count = bytes.sgetn(some.data(), some.size()))
    plain.append(some.data(), static_cast<std::size_t>(count));
  return plain;
}

template <class... Values>
void serialize_to(std::ostream& stream, const Values&... values) {
  cereal::PortableBinaryOutputArchive archive(stream);
  archive(values...);
}

template <class... Values>
std::string serialized(const Values&... values) {
  std::ostringstream stream;
  serialize_to(stream, values...);
  return std::move(stream).str();
}

template <class Value>
Value deserialized(const std::string& bytes) {
  std::istringstream stream(bytes);
  cereal::PortableBinaryInputArchive archive(stream);
  Value value;
  archive(value);
  return value;
}

/// The values are written twice, first to know how long they are: what they are written to could be as large
/// as they are.
template <class... Values>
std::string compressed(const Values&... values) {
  ByteCount count;
  std::ostream counted(&count);
  serialize_to(counted, values...);
  PackedBytes bytes(count.size());
  std::ostream stream(&bytes);
  serialize_to(stream, values...);
  return bytes.finish();
}

}  // namespace

std::string pack_text(const std::string& text) {
  PackedBytes bytes(text.size());
  bytes.sputn(text.data(), static_cast<std::streamsize>(text.size()));
  return bytes.finish();
}

std::string unpack_text(const std::string& bytes) {
  return decompress(bytes);
}

std::string pack_verdict(const Verdict& verdict) {
  return serialized(verdict);
}

Verdict unpack_verdict(const std::string& bytes) {
  return deserialized<Verdict>(bytes);
}

std::string pack_list(const std::vector<std::string>& list) {
  return list.empty() ? "" : nlohmann::json(list).dump();
}

std::vector<std::string> unpack_list(const std::string& packed) {
  if (packed.empty()) return {};
  return nlohmann::json::parse(packed).get<std::vector<std::string>>();
}

std::string pack_content(const Batch& batch) {
  return pack_text(nlohmann::json{{"title", batch.title}, {"tags", batch.tags}, {"jobs", batch.jobs}}.dump());
}

void unpack_content(const std::string& bytes, Batch& batch) {
  const auto content = nlohmann::json::parse(unpack_text(bytes));
  content.at("title").get_to(batch.title);
  content.at("tags").get_to(batch.tags);
  content.at("jobs").get_to(batch.jobs);
}

std::string pack_progress(const Progress& progress) {
  return serialized(progress);
}

Progress unpack_progress(const std::string& bytes) {
  return deserialized<Progress>(bytes);
}

std::string pack_iterations(const std::vector<Iteration>& iterations) {
  return serialized(iterations);
}

std::vector<Iteration> unpack_iterations(const std::string& bytes) {
  return deserialized<std::vector<Iteration>>(bytes);
}

std::string pack_findings(const Ending& ending) {
  if (ending.solution) return compressed(true, *ending.solution);
  return compressed(false, ending.history ? *ending.history : std::vector<Iteration>());
}

void unpack_findings(const ReadBytes& packed, JobResult& result) {
  PlainBytes(packed).check();
  PlainBytes plain(packed);
  std::istream stream(&plain);
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

std::size_t unpacked_size(const ReadBytes& packed) {
  constexpr std::size_t longest_head = 18;  // of a frame, RFC 8878
  std::array<char, longest_head> head;
  const auto size = ZSTD_getFrameContentSize(head.data(), packed(0, head));
  if (size == ZSTD_CONTENTSIZE_ERROR || size == ZSTD_CONTENTSIZE_UNKNOWN) throw damaged();
  return size;
}

}  // namespace signorini::server
