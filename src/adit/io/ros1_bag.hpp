// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#pragma once

#include "adit/core/result.hpp"
#include "adit/io/bag.hpp"

namespace adit {

/// A bag of ROS 1, format 2.0. Types are called as in ROS 2 ("sensor_msgs/msg/PointCloud2"; tf/tfMessage is
/// tf2_msgs/msg/TFMessage), messages have the encoding "ros1". Of a file without index, as an interrupted
/// recording leaves it (.bag.active), what is whole is read, which `warnings` says; of the chunk that it is
/// cut in what lies in front of the cut (decompress_front), of bz2 whole blocks of that, of LZ4 what no
/// checksum covers any more. Where the recorder did not come to state the chunk's size, 32 MiB of it at most.
/// Errors name the byte offset. Source: https://wiki.ros.org/Bags/Format/2.0.
[[nodiscard]] Result<Bag> open_ros1_bag(ByteSource source);

}  // namespace adit
