// Watches the memory of a running server and of a page on it, and says whether they grow.
//
//   node endurance.mjs http://127.0.0.1:8080/ PID WALL_MINUTES [OUT.csv]
//
// Every minute: the server's resident memory, the page's JavaScript heap after a collection, its DOM nodes and listeners, and how far
// the source's clock has come. Run it beside a replay at full speed and, for good measure, beside `curl -sN ADDRESS/api/events`.

import { appendFileSync, readFileSync } from "node:fs";
import { browser as launch, open, sleep } from "./bench.mjs";

const [address, pid, minutes, out] = process.argv.slice(2);
const say = (line) => {
  console.log(line);
  if (out) appendFileSync(out, line + "\n");
};
const resident_mb = () => {
  try {
    return +/VmRSS:\s+(\d+)/.exec(readFileSync(`/proc/${pid}/status`, "utf8"))[1] / 1024;
  } catch {
    return NaN;
  }
};

const browser = await launch();
const { page } = await open(browser, address);
const cdp = await page.context().newCDPSession(page);
await cdp.send("Performance.enable");
say("wall_min,source_h,seen_h,streams,server_rss_mb,heap_mb,nodes,listeners,status");
const begun_ms = Date.now();
const samples = [];
for (let minute = 0; minute <= +minutes && !Number.isNaN(resident_mb()); minute += 1) {
  await sleep(Math.max(0, begun_ms + minute * 60000 - Date.now()));
  await cdp.send("HeapProfiler.collectGarbage");
  const { metrics } = await cdp.send("Performance.getMetrics");
  const value = (name) => metrics.find((metric) => metric.name === name).value;
  let source_h = NaN, streams = NaN;
  try {
    const text = await (await fetch(new URL("/metrics", address))).text();
    source_h = +/\nitpms_source_time_seconds (\S+)/.exec(text)[1] / 3600;
    streams = +/\nitpms_http_streams (\S+)/.exec(text)[1];
  } catch {
    // The line then says NaN.
  }
  // What the page itself shows of the source's clock: whether it keeps up.
  const seen = await page.locator("#subline").innerText();
  const clock = /clock (?:(\d+) h )?(?:(\d+) min ?)?(?:([\d.]+) s)?/.exec(seen) ?? [];
  const seen_h = (+(clock[1] ?? 0) * 3600 + +(clock[2] ?? 0) * 60 + +(clock[3] ?? 0)) / 3600;
  const sample = { heap: value("JSHeapUsedSize") / 2 ** 20, rss: resident_mb() };
  samples.push(sample);
  say([((Date.now() - begun_ms) / 60000).toFixed(1), source_h.toFixed(2), seen_h.toFixed(2), streams, sample.rss.toFixed(1), sample.heap.toFixed(2), value("Nodes"), value("JSEventListeners"), await page.locator("#status-word").innerText()].join());
}
await browser.close();
