// What the tests stand on: the programs under test, and a Chromium that talks to nobody else.

import assert from "node:assert/strict";
import { spawn } from "node:child_process";
import { mkdtempSync, rmSync } from "node:fs";
import { tmpdir } from "node:os";
import { join } from "node:path";
import { chromium } from "playwright-core";

const FLAGS = ["--no-sandbox", "--disable-gpu", "--disable-quic", "--no-first-run", "--disable-background-networking", "--disable-component-update", "--disable-sync"];

export const browser = () => chromium.launch({ executablePath: process.env.CHROMIUM ?? "/usr/bin/chromium", args: FLAGS });

export const sleep = (ms) => new Promise((resolve) => setTimeout(resolve, ms));

// A page that remembers everything it complained of and everything it asked for.
export async function open(browser, address, options = {}) {
  const context = await browser.newContext({ viewport: { width: 1200, height: 1000 }, ...options });
  const page = await context.newPage(), complaints = [], asked = [];
  page.on("console", (message) => ["error", "warning"].includes(message.type()) && complaints.push(message.text()));
  page.on("pageerror", (error) => complaints.push(String(error)));
  page.on("request", (request) => asked.push(request.url()));
  await page.goto(address);
  return { page, complaints, asked, close: () => context.close() };
}

// A running program that has said where it listens.
class Running {
  constructor(child) {
    this.child = child;
    this.said = "";
    this.address = new Promise((resolve, reject) => {
      const listen = (chunk) => {
        this.said += chunk;
        const found = /http:\/\/[0-9.]+:\d+\//.exec(this.said);
        if (found) resolve(found[0]);
      };
      child.stdout.on("data", listen);
      child.stderr.on("data", listen);
      child.on("exit", () => reject(new Error("ended before it listened: " + this.said)));
      child.on("error", reject);
    });
    this.ended = new Promise((resolve) => child.on("exit", resolve));
  }
  type(line) {
    this.child.stdin.write(line + "\n");
  }
  async kill() {
    this.child.kill("SIGKILL");
    await this.ended;
  }
}

const start = (program, args, options) => new Running(spawn(program, args, { stdio: ["pipe", "pipe", "pipe"], ...options }));

// The example that makes up a car; it does what is typed.
export const madeUp = (address = "127.0.0.1:0", speed = 1) => start(process.env.ITPMS_MADE_UP, [address, String(speed)]);
export const itpms = (args, options) => start(process.env.ITPMS, args, options);

export function folder() {
  const path = mkdtempSync(join(tmpdir(), "itpms-dashboard-"));
  return { path, remove: () => rmSync(path, { recursive: true, force: true }) };
}

// Waits until something holds; says what it last was when it never does.
export async function until(what, of, holds, patience_ms = 10000) {
  const end = Date.now() + patience_ms;
  let last;
  do {
    last = await of();
    if (holds(last)) return last;
    await sleep(50);
  } while (Date.now() < end);
  assert.fail(`${what}: ${JSON.stringify(last)} after ${patience_ms} ms`);
}

export const text = (page, selector) => () => page.locator(selector).innerText();
export const state = (page, corner) => page.locator("#tire-" + corner).getAttribute("class");
