// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
// One map as `adit convert` wrote it in three formats has to be one map to readers that others wrote: LAS (copc), PCD and
// PLY (loaders.gl).
//   node clouds.mjs MAP.las MAP.pcd MAP.ply
import { readFileSync } from "node:fs";

import { parse } from "@loaders.gl/core";
import { PCDLoader } from "@loaders.gl/pcd";
import { PLYLoader } from "@loaders.gl/ply";
import copc from "copc";

const [lasFile, pcdFile, plyFile] = process.argv.slice(2);
const tolerance = 0.0006; // metres: half a step of LAS, and the rounding of the others

const bytes = readFileSync(lasFile);
const header = copc.Las.Header.parse(bytes);
const view = copc.Las.View.create(bytes.subarray(header.pointDataOffset), header);
const las = ["X", "Y", "Z", "PointSourceId"].map((name) => view.getter(name));
async function attributesOf(file, loader) {
  const { buffer, byteOffset, byteLength } = readFileSync(file);
  return (await parse(buffer.slice(byteOffset, byteOffset + byteLength), loader, { worker: false })).attributes;
}
const pcd = (await attributesOf(pcdFile, PCDLoader)).POSITION.value;
const ply = await attributesOf(plyFile, PLYLoader);

const number = header.pointCount;
const counts = [view.pointCount, pcd.length / 3, ply.POSITION.value.length / 3, ply.robot.value.length];
if (number === 0 || counts.some((count) => count !== number)) throw new Error(`${number} points, but ${counts}`);
const robots = new Set();
for (let i = 0; i < number; ++i) {
  const point = las.map((get) => get(i));
  for (let axis = 0; axis < 3; ++axis) {
    const others = [pcd[3 * i + axis], ply.POSITION.value[3 * i + axis]];
    if (others.some((value) => !(Math.abs(value - point[axis]) < tolerance)) || others[0] !== others[1])
      throw new Error(`point ${i}, axis ${axis}: ${point[axis]} in LAS, ${others[0]} in PCD, ${others[1]} in PLY`);
  }
  if (point[3] !== ply.robot.value[i]) throw new Error(`point ${i}: of robot ${point[3]} and ${ply.robot.value[i]}`);
  robots.add(point[3]);
}
for (const [axis, name] of ["x", "y", "z"].entries()) {
  let [low, high] = [Infinity, -Infinity];
  for (let i = axis; i < pcd.length; i += 3) [low, high] = [Math.min(low, pcd[i]), Math.max(high, pcd[i])];
  if (Math.abs(header.min[axis] - low) > tolerance || Math.abs(header.max[axis] - high) > tolerance)
    throw new Error(`the bounds of ${name} in LAS are ${header.min[axis]} to ${header.max[axis]}, not ${low} to ${high}`);
}
console.log(`crosscheck: ${number} points of ${robots.size} robots are the same in LAS ${header.majorVersion}.${header.minorVersion}, PCD and PLY`);
