// Pages that the program writes, in a real browser: at the width of a phone and of a desk, light and dark.
//
//   node pages.mjs OUT PAGE.html|http://...
//
// Of each: axe-core has nothing serious or critical, the console is silent, nothing is asked of a network, the page is not wider than its
// window, every part that can be operated is reached by Tab and is seen to be. A picture of each goes to OUT. CHROMIUM names the browser.

import { mkdirSync, readFileSync } from "node:fs";
import { createRequire } from "node:module";
import { basename, dirname, join, resolve } from "node:path";
import { pathToFileURL } from "node:url";
import { chromium } from "playwright-core";

const [out, ...pages] = process.argv.slice(2);
const AXE = readFileSync(createRequire(import.meta.url).resolve("axe-core/axe.min.js"), "utf8");
const FLAGS = ["--no-sandbox", "--disable-gpu", "--no-first-run", "--disable-background-networking"];
const WIDTHS = [390, 1440], SCHEMES = ["light", "dark"];
// Higher than any page should be on a desk; its pictures are cut there.
const TALLEST_PX = 16000;
// Tabs after which a page that has not come round is taken to hold the focus.
const TABS = 400;

// In the page: what can be operated and is there.
const operable = () => {
  const wanted = "a[href], button, input, select, textarea, summary, [tabindex]:not([tabindex='-1'])";
  const shown = (part) => part.checkVisibility({ visibilityProperty: true }) && part.getClientRects().length > 0;
  const parts = [...document.querySelectorAll(wanted)].filter((part) => !part.disabled && part.tabIndex >= 0 && shown(part));
  // Of a group of radio buttons Tab reaches one.
  const first = (part) => part.type !== "radio" || part.checked || ![...document.getElementsByName(part.name)].some((other) => other.checked);
  return parts.filter(first);
};

async function judged(browser, path, width, scheme) {
  const live = path.startsWith("http:"), address = live ? path : pathToFileURL(resolve(path)).href;
  const name = live ? "live" : basename(path) === "index.html" ? basename(dirname(path)) : basename(path, ".html");
  const where = `${name} ${width} ${scheme}`, faults = [];
  const context = await browser.newContext({ viewport: { width, height: 900 }, colorScheme: scheme, reducedMotion: "reduce" });
  const page = await context.newPage();
  page.on("console", (message) => ["error", "warning"].includes(message.type()) && faults.push(`console: ${message.text()}`));
  page.on("pageerror", (error) => faults.push(`error: ${error}`));
  page.on("request", (request) => !/^(file|data|blob):/.test(request.url()) && !(live && request.url().startsWith(new URL(address).origin)) && faults.push(`asks for ${request.url()}`));
  await page.goto(address);
  await page.waitForTimeout(1500);
  // All of it is laid out only once it was near, and what is folded is judged as well.
  await page.evaluate(() => document.querySelectorAll("details").forEach((part) => (part.dataset.was = part.open, part.open = true)));
  const wide = await page.evaluate(() => document.documentElement.scrollWidth - innerWidth);
  if (wide > 1) faults.push(`${wide} px wider than its window`);
  await page.evaluate(AXE);
  const found = await page.evaluate(() => axe.run(document, { resultTypes: ["violations"] }));
  for (const { id, impact, help, nodes } of found.violations)
    if (["serious", "critical"].includes(impact))
      faults.push(`axe ${impact} ${id}: ${help}; ${nodes.length} times, ${nodes[0].target} ${nodes[0].html.slice(0, 120)} ${nodes[0].any[0]?.message ?? ""}`);
  await page.evaluate(() => document.querySelectorAll("details").forEach((part) => (part.open = part.dataset.was === "true")));
  if (width === WIDTHS[1] && scheme === SCHEMES[0]) faults.push(...(await keyboard(page)));
  await page.evaluate(() => { document.activeElement?.blur(); scrollTo(0, 0); });
  // What is drawn when it comes into view has been in view.
  const height = await page.evaluate(() => document.documentElement.scrollHeight);
  for (let top = 0; top < Math.min(height, TALLEST_PX); top += 800) {
    await page.evaluate((top) => scrollTo(0, top), top);
    await page.waitForTimeout(40);
  }
  await page.evaluate(() => scrollTo(0, 0));
  await page.screenshot({ path: join(out, `${name}-${width}-${scheme}.png`), fullPage: true });
  await context.close();
  console.log(`${where}: ${height} px, ${faults.length ? faults.join("\n    ") : "good"}`);
  return faults.length;
}

// What Tab does not reach, and what does not show that it has.
async function keyboard(page) {
  const count = await page.evaluate(`(${operable})().length`);
  await page.evaluate(`(${operable})().forEach((part, i) => (part.dataset.tab = i))`);
  const reached = new Set(), unseen = [];
  for (let i = 0; i < Math.min(TABS, count + 5); i += 1) {
    await page.keyboard.press("Tab");
    const at = await page.evaluate(() => {
      const part = document.activeElement, style = getComputedStyle(part);
      const seen = part.matches(":focus-visible") && (style.outlineStyle !== "none" || style.boxShadow !== "none");
      return { tab: part.dataset?.tab, seen, html: part.outerHTML.slice(0, 100) };
    });
    if (at.tab === undefined) continue;
    reached.add(at.tab);
    if (!at.seen) unseen.push(at.html);
  }
  const missing = Math.min(count, TABS) - reached.size, faults = [];
  if (missing > 0) faults.push(`keyboard: ${missing} of ${count} parts are not reached by Tab`);
  if (unseen.length) faults.push(`keyboard: ${unseen.length} parts do not show their focus: ${unseen[0]}`);
  return faults;
}

mkdirSync(out, { recursive: true });
const browser = await chromium.launch({ executablePath: process.env.CHROMIUM ?? "/usr/bin/chromium", args: FLAGS });
let faults = 0;
for (const path of pages)
  for (const width of WIDTHS) for (const scheme of SCHEMES) faults += await judged(browser, path, width, scheme);
await browser.close();
console.log(`${pages.length} pages: ${faults} faults`);
process.exit(faults ? 1 : 0);
