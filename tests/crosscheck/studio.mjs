// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
// Opens a session as `adit convert SESSION session.mcap` wrote it in Foxglove Studio (1.48, the last whose source is open),
// as a user does: the recording by "Open local file", the layout beside it by "Import layout". Fails where Studio reports
// an error, or where what the layout shows is not seen: the map of each robot in its colour, loops in use, the cloud of a
// keyframe in the middle of the drive.
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
  "/session.layout.json": layout,
};
const types = { ".js": "text/javascript", ".html": "text/html", ".wasm": "application/wasm" };
const problems = [];
const size = { width: 1400, height: 900 };
const drawing = 8_000;  // milliseconds, without a graphics card

const { topics } = Object.values(JSON.parse(readFileSync(layout, "utf8")).configById)[0];
const shown = Object.keys(topics).filter((topic) => topics[topic].visible);
const expected = Object.entries(topics)
  .filter(([topic]) => topic.endsWith("/path"))
  .map(([topic, settings]) => [topic.slice(1, -5), settings.gradient[0], 400]);
expected.push(["loops in use", "#009e60", 50]);
expected.push(["clouds of keyframes", topics[shown.find((topic) => topic.endsWith("/points"))].flatColor, 100]);

const server = createServer((request, response) => {
  const { pathname } = new URL(request.url, "http://localhost");
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
async function answerWith(file, click) {
  await page.evaluate((name) => { window.nextFile = name; }, file);
  await click;
}

// Pixels of the picture whose colour is this one, lit more or less.
async function countPixels(png, color) {
  return page.evaluate(async ([base64, [r, g, b]]) => {
    const bytes = Uint8Array.from(atob(base64), (c) => c.charCodeAt(0));
    const image = await createImageBitmap(new Blob([bytes], { type: "image/png" }));
    const canvas = new OffscreenCanvas(image.width, image.height);
    const context = canvas.getContext("2d");
    context.drawImage(image, 0, 0);
    const { data } = context.getImageData(0, 0, image.width, image.height);
    let count = 0;
    for (let i = 0; i < data.length; i += 4) {
      const dot = data[i] * r + data[i + 1] * g + data[i + 2] * b;
      const length = Math.hypot(data[i], data[i + 1], data[i + 2]);
      const own = Math.hypot(r, g, b);
      if (dot > 0.99 * length * own && length > 0.5 * own && length < 1.1 * own) ++count;
    }
    return count;
  }, [png.toString("base64"), color]);
}
const rgb = (hex) => [1, 3, 5].map((at) => parseInt(hex.slice(at, at + 2), 16));

await page.goto(`http://localhost:${server.address().port}/`);
await answerWith("session.mcap", page.getByText("Open local file").click());
await page.getByRole("tab", { name: "Layouts" }).click();
await answerWith("session.layout.json", page.getByLabel("Import layout").click());
await page.getByText("session.layout", { exact: true }).waitFor();

// What Studio says of the recording, and of each topic in the panel's settings.
const badges = await page.locator(".MuiBadge-badge:not(.MuiBadge-invisible)").allInnerTexts();
if (badges.length > 0) problems.push(`problems with the recording: ${badges}`);
const settingsTab = page.getByRole("tab", { name: "Panel settings" });
await settingsTab.click();
await page.locator("canvas").first().click();
await page.waitForTimeout(drawing);
for (const topic of shown)
  if ((await page.getByText(topic, { exact: true }).count()) === 0) problems.push(`${topic} is not in the panel's settings`);
const errors = await page.getByTestId("ErrorIcon").count();
if (errors > 0) problems.push(`${errors} settings of the panel have errors`);

// Half way through, over the whole width.
await settingsTab.click();
await page.getByTestId("CloseIcon").click();
await page.mouse.click(size.width / 2, size.height - 57);  // the time line
await page.mouse.move(size.width / 2, 100);
await page.waitForTimeout(drawing);
const png = await page.screenshot({ path: picture });
for (const [what, color, least] of expected) {
  const count = await countPixels(png, rgb(color));
  console.log(`studio: ${what}: ${count} pixels`);
  if (count < least) problems.push(`${what}: ${count} pixels of ${color}, at least ${least} expected`);
}

await browser.close();
server.close();
for (const problem of problems) console.error(`studio: ${problem}`);
process.exit(problems.length > 0 ? 1 : 0);
