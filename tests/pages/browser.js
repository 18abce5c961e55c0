// A service and a browser that look at each other, for a test.

import assert from "node:assert/strict";
import { spawn } from "node:child_process";
import { createRequire } from "node:module";
import { mkdtempSync, readFileSync, rmSync } from "node:fs";
import { createServer } from "node:net";
import { tmpdir } from "node:os";
import { join } from "node:path";
import { createInterface } from "node:readline";
import { chromium } from "playwright-core";

const freePort = () => new Promise((resolve) => {
  const probe = createServer().listen(0, "127.0.0.1", () => { const { port } = probe.address(); probe.close(() => resolve(port)); });
});

/// `signorinid` on a port that it keeps when it is started again; ends with the test.
export class Service {
  static async start(...flags) {
    const own = new Service();
    own.directory = mkdtempSync(join(tmpdir(), "pages-"));
    own.port = await freePort();
    own.url = `http://127.0.0.1:${own.port}`;
    own.flags = flags;
    await own.begin();
    return own;
  }

  async begin() {
    this.process = spawn(process.env.SIGNORINID, ["--port", this.port, "--data-dir", this.directory, ...this.flags], { stdio: ["ignore", "ignore", "pipe"] });
    this.ended = new Promise((resolve) => { this.process.once("exit", resolve); });
    const lines = createInterface({ input: this.process.stderr });
    await new Promise((resolve, reject) => {
      lines.on("line", (line) => { if (line.includes("listening on ")) resolve(); });
      this.ended.then(() => reject(new Error("the service did not start")));
    });
  }

  async kill() {
    this.process.kill("SIGKILL");
    await this.ended;
  }

  async end() {
    await this.kill();
    rmSync(this.directory, { recursive: true });
  }

  async call(path, method = "GET", document) {
    const reply = await fetch(this.url + path, { method, headers: { "Content-Type": "application/json" }, body: document && JSON.stringify(document) });
    if (!reply.ok) throw new Error(`${method} ${path}: ${reply.status} ${await reply.text()}`);
    return reply.json();
  }

  example(name) {
    return this.call(`/v1/examples/${name}`);
  }
  async solve(problem) {
    return (await this.call("/v1/solves?wait=120&fields=summary", "POST", problem)).id;
  }
}

const launch = () => chromium.launch({ executablePath: process.env.CHROMIUM, args: ["--no-sandbox", "--use-angle=swiftshader", "--enable-unsafe-swiftshader"] });

/// A page that fails the test by whatever goes wrong in it: errors, and whatever the policy of the service forbids.
export async function newPage(browser, { width = 1280, height = 900, theme = "light", ...more } = {}) {
  const context = await browser.newContext({ viewport: { width, height }, colorScheme: theme, ...more });
  context.setDefaultTimeout(60000);
  const page = await context.newPage();
  page.faults = [];
  page.foreign = [];
  page.on("pageerror", (error) => page.faults.push(error.stack));
  page.on("console", (message) => { if (message.type() === "error" && !/net::ERR|status of (4|5)\d\d/.test(message.text())) page.faults.push(message.text()); });
  page.on("request", (request) => { if (!/^(http:\/\/127\.0\.0\.1|blob:|data:)/.test(request.url())) page.foreign.push(request.url()); });
  return page;
}

/// Nothing went wrong in the page, and nobody else was asked.
export function expectWell(page) {
  assert.deepEqual(page.faults, []);
  assert.deepEqual(page.foreign, []);
}

/// A service and a browser, and their end.
export const begin = (...flags) => Promise.all([Service.start(...flags), launch()]);
export async function end(service, browser) {
  await browser.close();
  await service.end();
}

/// The pixels of a canvas, read from a screenshot of it by the browser itself.
export async function pixelsOf(page, locator) {
  const picture = (await locator.screenshot()).toString("base64");
  const { width, height, data } = await page.evaluate(async (text) => {
    const bitmap = await createImageBitmap(new Blob([Uint8Array.from(atob(text), (c) => c.charCodeAt(0))], { type: "image/png" }));
    const canvas = new OffscreenCanvas(bitmap.width, bitmap.height), pen = canvas.getContext("2d");
    pen.drawImage(bitmap, 0, 0);
    const bytes = pen.getImageData(0, 0, bitmap.width, bitmap.height).data;
    return { width: bitmap.width, height: bitmap.height, data: bytes.reduce((all, byte) => all + String.fromCharCode(byte), "") };
  }, picture);
  return { width, height, data: Buffer.from(data, "latin1") };
}

const axe = readFileSync(createRequire(import.meta.url).resolve("axe-core/axe.min.js"), "utf8");

/// What axe has to say of the page, a line each.
export async function violations(page) {
  // By the debugger: the policy of the page forbids it to load foreign scripts.
  await page.evaluate(axe);
  const { violations: found } = await page.evaluate(() => window.axe.run(document, { resultTypes: ["violations"] }));
  return found.flatMap(({ id, nodes }) => nodes.map(({ target, failureSummary }) => `${id}: ${target} ${failureSummary}`));
}

/// A frame of the picture has been drawn with this field, if it is named.
export const drawn = (page) => page.waitForFunction(() => document.querySelector(".ticks li") && !document.querySelector(".pictures [role=status]"));

/// What comes soon: the check is made again until it holds, and after a minute throws what it misses.
export async function eventually(check) {
  for (const begun = Date.now(); ; await new Promise((resolve) => setTimeout(resolve, 100))) {
    try {
      return await check();
    } catch (missing) {
      if (Date.now() - begun > 60000) throw missing;
    }
  }
}
