// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
/// The compressions of the chunks of bags, "" (none), "lz4" (LZ4 frames), "zstd" and "bz2", and LZF, that of
/// PCD files.
#pragma once

#include <cstddef>
#include <string>
#include <string_view>

#include "adit/core/result.hpp"

namespace adit {

/// zstd at its fastest ordinary level: point clouds are mostly noise, and higher ones gain little.
[[nodiscard]] std::string compress_zstd(std::string_view bytes);

/// Exactly `size` bytes, or an error; more than so few bytes can hold is refused as damage, and more than 1
/// GiB, of zstd only where that is more than 64 times `bytes`. Of zstd beyond that many times, and of bz2,
/// memory is taken as data come.
Result<std::string> decompress(std::string_view bytes, std::string_view compression, std::size_t size);

/// Of data that are cut: as many of the `size` bytes as what is there gives, at most all. More than a few
/// zeros at its end, as a loss of power leaves them, are not taken for data. What is damaged ends it; but
/// only where a checksum is there, damage is sure to be found, and else bytes behind it may be wrong.
///  - "": all bytes.
///  - zstd: whole blocks, of up to 128 kB, without checksums.
///  - lz4: whole blocks, and of the one that is cut what stands in front of the cut. Blocks seldom have
///    checksums, and the one that is cut never has: the last 64 bytes are not given. Of a frame that is whole
///    but damaged nothing is given.
///  - bz2: whole blocks, of 100 to 900 kB, which is more than most chunks. They have checksums; where one of
///    these does not fit, nothing is given.
///
/// Memory is taken as data come.
[[nodiscard]] std::string decompress_front(std::string_view bytes, std::string_view compression,
                                           std::size_t size);

/// Whether the bytes begin as a zstd frame does.
[[nodiscard]] bool is_zstd(std::string_view bytes);
/// A zstd frame that states its own size; bounds as of decompress.
Result<std::string> decompress_zstd_frame(std::string_view bytes);

/// LZF, as in PCD's binary_compressed.
[[nodiscard]] std::string compress_lzf(std::string_view bytes);

/// Exactly `size` bytes, or an error; a `size` that so few bytes cannot hold is refused as damage.
Result<std::string> decompress_lzf(std::string_view bytes, std::size_t size);

}  // namespace adit
