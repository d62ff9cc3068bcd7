// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
// Opens a session as `adit convert SESSION session.mcap` wrote it in Foxglove Studio (1.48, the last whose source is open),
// as a user does: the recording by "Open local file", the layout beside it by "Import layout". Fails where Studio reports
// an error, or where what the layout shows is not seen: the map of each robot in its colour, the cloud of a keyframe in the
// middle of the drive, and loops, without which the picture is another.
//   node studio.mjs SESSION.mcap PICTURE.png
import { createReadStream, existsSync, readFileSync, statSync } from "node:fs";
import { createServer } from "node:http";
import { createRequire } from "node:module";
import { dirname, extname, join } from "node:path";
import { fileURLToPath } from "node:url";

import { chromium } from "playwright-core";

const [session, picture] = process.argv.slice(2);
const layout = session.replace(/\.mcap$/, ".layout.json");
const here = dirname(fileURLToPath(import.meta.url));
const packages = (path) => join(dirname(createRequire(import.meta.url).resolve("react/package.json")), "..", path);
const files = {
  "/": join(here, "studio.html"),
  "/react.js": packages("react/umd/react.production.min.js"),
  "/react-dom.js": packages("react-dom/umd/react-dom.production.min.js"),
  "/session.mcap": session,
};
let served; // The layout that is imported next.
const types = { ".js": "text/javascript", ".html": "text/html", ".wasm": "application/wasm" };
const problems = [];
const size = { width: 1400, height: 900 };
const drawing = 8_000;  // milliseconds, without a graphics card

const withLoops = JSON.parse(readFileSync(layout, "utf8"));
const { topics } = Object.values(withLoops.configById)[0];
const withoutLoops = structuredClone(withLoops);
Object.values(withoutLoops.configById)[0].topics["/graph"].visible = false;
const expected = Object.entries(topics)
  .filter(([topic]) => topic.endsWith("/path"))
  .map(([topic, settings]) => [topic.slice(1, -5), settings.gradient[0], 400]);
expected.push(["clouds of keyframes", Object.entries(topics).find(([topic]) => topic.endsWith("/points"))[1].flatColor, 100]);

const server = createServer((request, response) => {
  const { pathname } = new URL(request.url, "http://localhost");
  if (pathname === "/session.layout.json") return response.end(JSON.stringify(served));
  const file = files[pathname] ?? packages(join("@foxglove/studio-base/assets", pathname));
  const found = existsSync(file) && statSync(file).isFile();
  response.writeHead(found ? 200 : 404, { "content-type": types[extname(file)] ?? "application/octet-stream" });
  found ? createReadStream(file).pipe(response) : response.end();
});
await new Promise((resolve) => server.listen(0, "localhost", resolve));

const browser = await chromium.launch({
  executablePath: "/usr/bin/chromium",
  args: ["--no-sandbox", "--use-angle=swiftshader", "--enable-unsafe-swiftshader", "--ignore-gpu-blocklist"],
});

// Half way through the session, over the whole width.
async function pictureOf(layoutToImport, path) {
  served = layoutToImport;
  const page = await browser.newPage({ viewport: size });
  page.setDefaultTimeout(120_000);
  page.on("console", (message) => message.type() === "error" && problems.push(message.text()));
  page.on("pageerror", (error) => problems.push(String(error)));
  // A browser without a screen has no dialog that asks for a file: the next one is answered with this file.
  await page.addInitScript(() => {
    window.showOpenFilePicker = async () => {
      const folder = await navigator.storage.getDirectory();
      const handle = await folder.getFileHandle(window.nextFile, { create: true });
      const writable = await handle.createWritable();
      await writable.write(await (await fetch(window.nextFile)).blob());
      await writable.close();
      return [handle];
    };
  });
  const answerWith = (file) => page.evaluate((name) => { window.nextFile = name; }, file);
  await page.goto(`http://localhost:${server.address().port}/`);
  await answerWith("session.mcap");
  await page.getByText("Open local file").click();
  await page.getByRole("tab", { name: "Layouts" }).click();
  await answerWith("session.layout.json");
  await page.getByLabel("Import layout").click();
  await page.getByText("session.layout", { exact: true }).waitFor();
  await checkWhatStudioSays(page);
  await page.getByTestId("CloseIcon").click();
  await page.mouse.click(size.width / 2, size.height - 57); // the time line
  await page.mouse.move(size.width / 2, 100);
  await page.waitForTimeout(drawing);
  const png = await page.screenshot({ path });
  const pixels = await pixelsOf(page, png);
  await page.close();
  return pixels;
}

// Of the recording, and of each topic in the panel's settings, which are folded away again.
async function checkWhatStudioSays(page) {
  const badges = await page.locator(".MuiBadge-badge:not(.MuiBadge-invisible)").allInnerTexts();
  if (badges.length > 0) problems.push(`problems with the recording: ${badges}`);
  const settings = page.getByRole("tab", { name: "Panel settings" });
  await settings.click();
  await page.locator("canvas").first().click();
  await page.waitForTimeout(drawing);
  for (const topic of Object.keys(topics))
    if (topics[topic].visible && (await page.getByText(topic, { exact: true }).count()) === 0)
      problems.push(`${topic} is not in the panel's settings`);
  const errors = await page.getByTestId("ErrorIcon").count();
  if (errors > 0) problems.push(`${errors} settings of the panel have errors`);
  await settings.click();
}

// Red, green and blue of each pixel, in turn.
async function pixelsOf(page, png) {
  const text = await page.evaluate(async (base64) => {
    const bytes = Uint8Array.from(atob(base64), (c) => c.charCodeAt(0));
    const image = await createImageBitmap(new Blob([bytes], { type: "image/png" }));
    const context = new OffscreenCanvas(image.width, image.height).getContext("2d");
    context.drawImage(image, 0, 0);
    const { data } = context.getImageData(0, 0, image.width, image.height);
    let out = "";
    for (let i = 0; i < data.length; i += 4) out += String.fromCharCode(data[i], data[i + 1], data[i + 2]);
    return out;
  }, png.toString("base64"));
  return Uint8Array.from(text, (c) => c.charCodeAt(0));
}

// Pixels of this colour, lit more or less.
function countOf(pixels, hex) {
  const color = [1, 3, 5].map((at) => parseInt(hex.slice(at, at + 2), 16));
  const own = Math.hypot(...color);
  let count = 0;
  for (let i = 0; i < pixels.length; i += 3) {
    const dot = pixels[i] * color[0] + pixels[i + 1] * color[1] + pixels[i + 2] * color[2];
    const length = Math.hypot(pixels[i], pixels[i + 1], pixels[i + 2]);
    if (dot > 0.99 * length * own && length > 0.5 * own && length < 1.1 * own) ++count;
  }
  return count;
}

const pixels = await pictureOf(withLoops, picture);
const without = await pictureOf(withoutLoops);
for (const [what, color, least] of expected) {
  const count = countOf(pixels, color);
  console.log(`studio: ${what}: ${count} pixels`);
  if (count < least) problems.push(`${what}: ${count} pixels of ${color}, at least ${least} expected`);
}
let ofLoops = 0;
for (let i = 0; i < pixels.length; i += 3)
  if (pixels[i] < without[i] - 40 && pixels[i + 1] > pixels[i] + 20) ++ofLoops; // greener
console.log(`studio: loops in use: ${ofLoops} pixels`);
if (ofLoops < 50) problems.push(`loops in use: ${ofLoops} pixels, at least 50 expected`);

await browser.close();
server.close();
for (const problem of problems) console.error(`studio: ${problem}`);
process.exit(problems.length > 0 ? 1 : 0);
