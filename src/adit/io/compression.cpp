// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/io/compression.hpp"

#include <bzlib.h>
#include <liblzf/lzf.h>
#include <lz4.h>
#include <lz4frame.h>
#include <zstd.h>

#include <algorithm>
#include <cstdint>
#include <cstring>
#include <memory>

#include "adit/core/check.hpp"
#include "adit/core/format.hpp"

namespace adit {
namespace {

constexpr std::size_t kLargest = std::size_t{1} << 30U;
constexpr std::size_t kUsualOfZstd = 64;  // bytes that one stands for: of chunks, and of maps of long drives
/// Bytes of memory that are taken before data show that they need more.
constexpr std::size_t kFirst = std::size_t{1} << 20U;
// Bytes that one compressed byte can stand for: a zstd block of 128 KiB that repeats one byte takes four, LZ4
// counts runs in 255s, and a block of 900 kB of bzip2, in which five bytes stand for 259, takes some 32.
constexpr std::size_t kMostOfZstd = 32768;
constexpr std::size_t kMostOfLz4 = 255;
constexpr std::size_t kMostOfBz2 = 3'000'000;

/// Before memory is taken for them.
Result<> check_claim(std::string_view bytes, std::size_t size, std::size_t most_of_a_byte) {
  if (size / most_of_a_byte <= bytes.size()) return {};
  return fail(format("{} compressed bytes cannot hold {} bytes; the size is damaged", bytes.size(), size));
}

/// Some kilobytes can stand for so much that `check_claim` passes a damaged size: memory is taken only as
/// data come. Through a buffer of zstd's own, which takes longer than all at once.
Result<std::string> decompress_zstd_by_steps(std::string_view bytes, std::size_t size) {
  const std::unique_ptr<ZSTD_DCtx, decltype(&ZSTD_freeDCtx)> context(ZSTD_createDCtx(), &ZSTD_freeDCtx);
  ADIT_CHECK(context != nullptr, "out of memory");
  ZSTD_inBuffer in{bytes.data(), bytes.size(), 0};
  const std::size_t most = size + 1;  // a byte more tells whether the data end there
  std::string out(std::min(most, kFirst), '\0');
  for (std::size_t done = 0;;) {
    ZSTD_outBuffer to{out.data(), out.size(), done};
    const std::size_t state = ZSTD_decompressStream(context.get(), &to, &in);  // 0: a frame has ended
    if (ZSTD_isError(state) != 0) return fail(format("damaged zstd data: {}", ZSTD_getErrorName(state)));
    done = to.pos;
    if (done == most) return fail(format("zstd data expand to more than {} bytes", size));
    if (in.pos == in.size && state == 0) {
      if (done != size) return fail(format("zstd data expand to {} bytes, not {}", done, size));
      out.resize(size);
      return out;
    }
    if (done == out.size())
      out.resize(std::min(most, 2 * out.size()));
    else if (in.pos == in.size)
      return fail(format("zstd data end early, after {} of {} bytes", done, size));
  }
}

Result<std::string> decompress_zstd(std::string_view bytes, std::size_t size) {
  // A frame states its size as well. Where it is the only one, a claim that differs is damage, found before
  // memory is taken.
  const unsigned long long stated = ZSTD_getFrameContentSize(bytes.data(), bytes.size());
  if (stated == ZSTD_CONTENTSIZE_ERROR) return fail("not a zstd frame");
  const bool is_only_one = ZSTD_findFrameCompressedSize(bytes.data(), bytes.size()) == bytes.size();
  if (stated != ZSTD_CONTENTSIZE_UNKNOWN && (is_only_one ? stated != size : stated > size))
    return fail(format("holds {} bytes, not {}", stated, size));
  if (const Result<> possible = check_claim(bytes, size, kMostOfZstd); !possible)
    return tl::unexpected(possible.error());
  if (size > kFirst && size / kUsualOfZstd > bytes.size()) return decompress_zstd_by_steps(bytes, size);
  std::string out(size, '\0');
  const std::size_t got = ZSTD_decompress(out.data(), out.size(), bytes.data(), bytes.size());
  if (ZSTD_isError(got) != 0) return fail(format("damaged zstd data: {}", ZSTD_getErrorName(got)));
  if (got != size) return fail(format("zstd data expand to {} bytes, not {}", got, size));
  return out;
}

Result<std::string> decompress_lz4(std::string_view bytes, std::size_t size) {
  if (const Result<> possible = check_claim(bytes, size, kMostOfLz4); !possible)
    return tl::unexpected(possible.error());
  LZ4F_dctx* context = nullptr;
  ADIT_CHECK(LZ4F_isError(LZ4F_createDecompressionContext(&context, LZ4F_VERSION)) == 0, "out of memory");
  const std::unique_ptr<LZ4F_dctx, decltype(&LZ4F_freeDecompressionContext)> owner(
      context, &LZ4F_freeDecompressionContext);
  std::string out(size, '\0');
  std::size_t done = 0;
  for (std::size_t hint = 1; hint != 0;) {
    std::size_t produced = out.size() - done;
    std::size_t consumed = bytes.size();
    hint = LZ4F_decompress(context, out.data() + done, &produced, bytes.data(), &consumed, nullptr);
    if (LZ4F_isError(hint) != 0) return fail(format("damaged lz4 data: {}", LZ4F_getErrorName(hint)));
    if (hint != 0 && produced == 0 && consumed == 0)
      return fail(format("lz4 data end early or exceed {} bytes", size));
    done += produced;
    bytes.remove_prefix(consumed);
  }
  if (done != size) return fail(format("lz4 data expand to {} bytes, not {}", done, size));
  return out;
}

/// A stream of the library over bytes that it keeps.
struct Bz2Reader {
  explicit Bz2Reader(std::string_view bytes) : in(bytes) {
    ADIT_CHECK(BZ2_bzDecompressInit(&stream, 0, 0) == BZ_OK, "out of memory");
    stream.next_in = in.data();
    stream.avail_in = static_cast<unsigned>(in.size());
  }
  ~Bz2Reader() { BZ2_bzDecompressEnd(&stream); }
  Bz2Reader(const Bz2Reader&) = delete;
  Bz2Reader& operator=(const Bz2Reader&) = delete;

  std::string in;  ///< A copy: the library's argument is not const.
  bz_stream stream = {};
};

/// A few bytes of bzip2 can stand for so much that `check_claim` passes a damaged size: memory is taken only
/// as data come.
Result<std::string> decompress_bz2(std::string_view bytes, std::size_t size) {
  if (const Result<> possible = check_claim(bytes, size, kMostOfBz2); !possible)
    return tl::unexpected(possible.error());
  Bz2Reader reader(bytes);
  bz_stream& stream = reader.stream;
  const std::size_t most = size + 1;  // a byte more tells whether the data end there
  std::string out(std::min(most, kFirst), '\0');
  for (std::size_t done = 0;;) {
    stream.next_out = out.data() + done;
    stream.avail_out = static_cast<unsigned>(out.size() - done);
    const int code = BZ2_bzDecompress(&stream);
    done = out.size() - stream.avail_out;
    if (code == BZ_STREAM_END) {
      if (done != size) return fail(format("bz2 data expand to {} bytes, not {}", done, size));
      out.resize(size);
      return out;
    }
    ADIT_CHECK(code != BZ_MEM_ERROR, "out of memory");
    if (code != BZ_OK) return fail(format("damaged bz2 data (code {})", code));
    if (stream.avail_out > 0) return fail(format("bz2 data end early, after {} of {} bytes", done, size));
    if (done == most) return fail(format("bz2 data expand to more than {} bytes", size));
    out.resize(std::min(most, 2 * out.size()));
  }
}

/// What `give` puts into the room that it is shown, call by call, until it puts nothing there or `size` bytes
/// have come. Memory is taken as they come.
template <class Give>
std::string collected(std::size_t size, const Give& give) {
  std::string out;
  for (std::size_t done = 0;;) {
    if (done == out.size()) out.resize(std::min(size, std::max(kFirst, 2 * done)));
    const std::size_t given = done < out.size() ? give(out.data() + done, out.size() - done) : 0;
    done += given;
    if (given > 0) continue;
    out.resize(done);
    return out;
  }
}

std::string front_of_zstd(std::string_view bytes, std::size_t size) {
  const std::unique_ptr<ZSTD_DCtx, decltype(&ZSTD_freeDCtx)> context(ZSTD_createDCtx(), &ZSTD_freeDCtx);
  ADIT_CHECK(context != nullptr, "out of memory");
  ZSTD_inBuffer in{bytes.data(), bytes.size(), 0};
  return collected(size, [&](char* to, std::size_t room) {
    ZSTD_outBuffer out{to, room, 0};
    std::size_t state = 1;
    while (out.pos == 0 && in.pos < in.size && ZSTD_isError(state) == 0)
      state = ZSTD_decompressStream(context.get(), &out, &in);
    return out.pos;
  });
}

constexpr std::size_t kLargestLz4Block = std::size_t{4} << 20U;

/// How a frame of LZ4 ends.
struct Lz4End {
  bool is_whole = false;            ///< All of its blocks are there, and the mark behind them.
  std::string_view cut_block = {};  ///< Else the compressed one that it is cut in; "": it is cut elsewhere.
};

Lz4End end_of_lz4(std::string_view frame) {
  constexpr std::uint32_t kFrame = 0x184D2204;  // LZ4F_headerSize also takes frames that hold no data
  constexpr std::uint32_t kStored = 1U << 31U;  // the library hands out the bytes of such blocks as they come
  constexpr unsigned kHasChecksums = 0x10;
  const auto word_at = [&](std::size_t at) {
    std::uint32_t word = 0;
    std::memcpy(&word, frame.data() + at, sizeof(word));  // little-endian, as the machine
    return word;
  };
  const std::size_t head = LZ4F_headerSize(frame.data(), frame.size());
  if (LZ4F_isError(head) != 0 || word_at(0) != kFrame) return {};
  const std::size_t checksum = (static_cast<unsigned char>(frame[4]) & kHasChecksums) != 0 ? 4 : 0;
  for (std::size_t at = head; at + 4 <= frame.size();) {
    const std::uint32_t word = word_at(at);
    if (word == 0) return {.is_whole = true};
    const std::size_t size = word & ~kStored;
    at += sizeof(word);
    if (size + checksum > frame.size() - at) {
      const bool is_compressed = (word & kStored) == 0 && size <= kLargestLz4Block;
      return {.cut_block = is_compressed ? frame.substr(at, size) : ""};
    }
    at += size + checksum;
  }
  return {};
}

/// Adds what can be read of a block that is cut, `out` to have `size` bytes at most. Blocks refer back to
/// those before them, which are in `out`.
void append_cut_lz4_block(std::string_view block, std::size_t size, std::string& out) {
  constexpr std::size_t kReach = std::size_t{64} << 10U;
  if (block.empty()) return;
  const std::size_t done = out.size();
  const std::size_t room = std::min(size - done, kLargestLz4Block);
  const std::size_t before = std::min(done, kReach);
  out.resize(done + room);
  char* const to = out.data() + done;
  int given = -1;
  // The library refuses a block that ends inside of a length: it is given less, then.
  for (std::size_t less = 0; given < 0 && less < block.size(); less = std::max<std::size_t>(1, 2 * less))
    given = LZ4_decompress_safe_partial_usingDict(block.data(), to, static_cast<int>(block.size() - less),
                                                  static_cast<int>(room), static_cast<int>(room), to - before,
                                                  static_cast<int>(before));
  out.resize(done + static_cast<std::size_t>(std::max(given, 0)));
}

std::string front_of_lz4(std::string_view bytes, std::size_t size) {
  constexpr std::size_t kMargin = 64;  // nothing verifies the last bytes: so no message ends with them
  LZ4F_dctx* context = nullptr;
  ADIT_CHECK(LZ4F_isError(LZ4F_createDecompressionContext(&context, LZ4F_VERSION)) == 0, "out of memory");
  const std::unique_ptr<LZ4F_dctx, decltype(&LZ4F_freeDecompressionContext)> owner(
      context, &LZ4F_freeDecompressionContext);
  std::string_view rest = bytes;
  std::size_t hint = 1;  // 0: the frame has ended
  std::string out = collected(size, [&](char* to, std::size_t room) {
    std::size_t given = 0;
    while (given == 0 && hint != 0) {
      std::size_t taken = rest.size();
      given = room;
      hint = LZ4F_decompress(context, to, &given, rest.data(), &taken, nullptr);
      if (LZ4F_isError(hint) != 0) return std::size_t{0};
      rest.remove_prefix(taken);
      if (taken == 0) break;
    }
    return given;
  });
  const Lz4End end = end_of_lz4(bytes);
  // Of a frame that is whole, but not the one that was written, nothing tells which bytes are right.
  if (LZ4F_isError(hint) != 0) return end.is_whole ? std::string() : out;
  if (hint == 0 || end.is_whole) return out;
  append_cut_lz4_block(end.cut_block, size, out);
  if (out.size() < size) out.resize(out.size() - std::min(out.size(), kMargin));
  return out;
}

std::string front_of_bz2(std::string_view bytes, std::size_t size) {
  Bz2Reader reader(bytes);
  bz_stream& stream = reader.stream;
  int code = BZ_OK;
  std::string out = collected(size, [&](char* to, std::size_t room) {
    if (code != BZ_OK) return std::size_t{0};
    stream.next_out = to;
    stream.avail_out = static_cast<unsigned>(room);
    code = BZ2_bzDecompress(&stream);
    ADIT_CHECK(code != BZ_MEM_ERROR, "out of memory");
    return room - stream.avail_out;
  });
  // A block is handed out before its checksum is looked at.
  const bool is_damaged = code != BZ_OK && code != BZ_STREAM_END;
  return is_damaged ? std::string() : out;
}

}  // namespace

std::string compress_zstd(std::string_view bytes) {
  std::string out(ZSTD_compressBound(bytes.size()), '\0');
  const std::size_t size = ZSTD_compress(out.data(), out.size(), bytes.data(), bytes.size(), 1);
  ADIT_CHECK(ZSTD_isError(size) == 0, "zstd fails only when its buffer is too small");
  out.resize(size);
  return out;
}

bool is_zstd(std::string_view bytes) { return bytes.starts_with("\x28\xB5\x2F\xFD"); }

Result<std::string> decompress_zstd_frame(std::string_view bytes) {
  const unsigned long long stated = ZSTD_getFrameContentSize(bytes.data(), bytes.size());
  if (stated == ZSTD_CONTENTSIZE_ERROR || stated == ZSTD_CONTENTSIZE_UNKNOWN)
    return fail("a zstd frame that does not state its size");
  return decompress(bytes, "zstd", stated);
}

Result<std::string> decompress(std::string_view bytes, std::string_view compression, std::size_t size) {
  const bool is_large_zstd = compression == "zstd" && size / kUsualOfZstd <= bytes.size();
  if (size > kLargest && !is_large_zstd)
    return fail(format("{} uncompressed bytes are announced; 1 GiB is the most", size));
  if (compression == "zstd") return decompress_zstd(bytes, size);
  if (compression == "lz4") return decompress_lz4(bytes, size);
  if (compression == "bz2") return decompress_bz2(bytes, size);
  if (!compression.empty())
    return fail(format("compression '{}' is unknown; lz4, zstd and bz2 are known", compression));
  if (bytes.size() != size) return fail(format("{} bytes, not the {} announced", bytes.size(), size));
  return std::string(bytes);
}

std::string decompress_front(std::string_view bytes, std::string_view compression, std::size_t size) {
  constexpr std::size_t kMostByChance = 16;  // so many zeros may be data; a loss of power leaves more
  const std::size_t end = bytes.find_last_not_of('\0') + 1;  // 0 where all are zeros
  if (bytes.size() - end > kMostByChance) bytes = bytes.substr(0, end);
  if (compression == "zstd") return front_of_zstd(bytes, size);
  if (compression == "lz4") return front_of_lz4(bytes, size);
  if (compression == "bz2") return front_of_bz2(bytes, size);
  return compression.empty() ? std::string(bytes.substr(0, size)) : std::string();
}

std::string compress_lzf(std::string_view bytes) {
  if (bytes.empty()) return {};
  // Runs of at most 32 literal bytes have one byte of head each; the library wants a little more than that.
  std::string out(bytes.size() + bytes.size() / 16 + 64, '\0');
  const unsigned size = lzf_compress(bytes.data(), static_cast<unsigned>(bytes.size()), out.data(),
                                     static_cast<unsigned>(out.size()));
  ADIT_CHECK(size > 0, "lzf fails only when its buffer is too small");
  out.resize(size);
  return out;
}

Result<std::string> decompress_lzf(std::string_view bytes, std::size_t size) {
  constexpr std::size_t kLongestRun = 264;  // that two or three bytes of LZF stand for
  if (size > kLargest || size / kLongestRun > bytes.size())
    return fail(format("{} LZF bytes cannot hold {} bytes; the size is damaged", bytes.size(), size));
  std::string out(size, '\0');
  const unsigned got = lzf_decompress(bytes.data(), static_cast<unsigned>(bytes.size()), out.data(),
                                      static_cast<unsigned>(out.size()));
  if (got == 0 && size > 0) return fail(format("damaged LZF data, or more than {} bytes of it", size));
  if (got != size) return fail(format("LZF data expand to {} bytes, not {}", got, size));
  return out;
}

}  // namespace adit
